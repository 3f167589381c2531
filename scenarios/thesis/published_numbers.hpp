#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <string>

/// The numbers that the thesis publishes, by id: results/reference/published.json.
namespace hapbench {

/// A published number. A part that is not published has its default value.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// Holds no number.
  PublishedNumbers() = default;
  /// Reads the file. Throws InputError.
  explicit PublishedNumbers(const std::filesystem::path& file);
  /// Returns the number with this id. Throws InputError for an id that is not there.
  const PublishedNumber& operator[](const std::string& id) const;
  /// Returns the text with the numbers that it names by id: <T2.raw> becomes "37.8 ± 17.7", <T3.reduced.bound.at_most>
  /// "15". A part (mean, spread, at_least or at_most) may have a factor and a format, as <J1.depth.mean*1000:.2f>;
  /// without one it is `plain`; no number is "none". Throws InputError for an id that is not there.
  std::string fill(const std::string& text) const;
  /// Adds a number of ours that rules read as they read published ones: a threshold (choices.hpp).
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// Returns a number as the rules of claims write it, with six digits at most: "0.1", "15", "1e-9".
std::string plain(double number);

/// Returns a threshold of ours: the choice rule.NAME. Throws InputError for an unknown name.
double threshold(const PublishedNumbers& numbers, const std::string& name);

}  // namespace hapbench
