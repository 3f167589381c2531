#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <string>

/// The numbers that the thesis publishes, by id (results/reference/published.json).
namespace hapbench {

/// A published number. Members that are not published keep their default values.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  /// Published bounds.
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// Creates an empty set.
  PublishedNumbers() = default;
  /// Reads the numbers from `file`. Throws InputError if the file cannot be read or has another format.
  explicit PublishedNumbers(const std::filesystem::path& file);
  /// Returns the number with this id. Throws InputError for an unknown id.
  const PublishedNumber& operator[](const std::string& id) const;
  /// Returns the text with each <ID> or <ID.MEMBER> replaced by the number: <T2.raw> becomes "37.8 ± 17.7",
  /// <T3.reduced.bound.at_most> becomes "15". A member (mean, spread, at_least or at_most) may have a factor and a
  /// format, such as <J1.depth.mean*1000:.2f>; without a format it is written by plain(), and NaN as "none". Throws
  /// InputError for an unknown id.
  std::string fill(const std::string& text) const;
  /// Sets the mean of a number that the thesis does not publish, such as a threshold (assumptions.hpp) or a measured
  /// number.
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// Returns a number as text with at most six digits, such as "0.1", "15", "1e-9".
std::string plain(double number);

/// Returns a threshold of the rules that judge claims: the mean of the number with the id "rule." + `name`. The
/// thresholds are assumptions of this project and not published. Throws InputError for an unknown name.
double threshold(const PublishedNumbers& numbers, const std::string& name);

}  // namespace hapbench
