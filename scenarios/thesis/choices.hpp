#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "scenarios/input/installed_folder.hpp"
#include "scenarios/thesis/claims.hpp"

/// Choices that the thesis leaves open and that the bundled scenarios make, and the claims judged again under other
/// readings of them. results/reference/choices.json has the choices; choices.schema.json beside it says what each part
/// means and what is allowed; a test checks the file by it.
namespace hapbench {

/// A field that a choice sets, in the scenarios that have it.
struct ChosenField {
  std::vector<std::string> scenarios;  ///< names of bundled ones; '*' stands for any characters
  std::string path;                    ///< dotted, as in --set; '*' stands for every index of a list
  bool times = false;                  ///< the choice multiplies what the file has, instead of replacing it
};

struct OpenChoice {
  std::string id = {};
  std::string value = {};                               ///< as the scenarios have it, a text as in --set
  std::optional<std::pair<double, double>> range = {};  ///< plausible values of a number; exactly one of this …
  std::vector<std::string> options = {};                ///< … and these, texts as in --set
  std::vector<ChosenField> fields = {};                 ///< none for a number that rules read by the choice's id
  std::string text = {};                                ///< all of it, as in the file
};

/// All choices on record.
class Choices {
 public:
  /// Reads the file. Throws InputError with the JSON pointer of a choice that lacks a part or has another type of it.
  explicit Choices(const std::filesystem::path& file);

  const std::vector<OpenChoice>& all() const { return all_; }
  /// FNV-1a of the file's content, as 16 hexadecimal digits; spelling and white space do not count.
  const std::string& hash() const { return hash_; }

  /// One for each choice, as texts for --set.
  std::vector<std::string> values_on_record() const { return names_of(all_, &OpenChoice::value); }

  /// The changes that these values, one for each choice, make to a scenario, as overrides for load_scenario. Choices of
  /// one field are applied in order. Throws InputError when a choice's path is no field of a scenario that it names, or
  /// a field to multiply is no number.
  std::vector<std::string> overrides(const Scenario& scenario, std::span<const std::string> values) const;

  /// The published numbers and those of the choices without fields.
  PublishedNumbers with_numbers(PublishedNumbers published, std::span<const std::string> values) const {
    for (std::size_t i = 0; i < all_.size(); ++i)
      if (all_[i].fields.empty()) published.set(all_[i].id, finite_number(values[i]).value());
    return published;
  }

  /// Hash of the choices that reach a claim: those that concern one of these scenarios, and numbers that the rule's
  /// text names, as in <rule.easily>. Empty when none does.
  std::string reach(std::span<const std::string> scenarios, const std::string& rule) const;

 private:
  std::vector<OpenChoice> all_;
  std::string hash_;
};

/// The JSON Schema (draft 7) of that file, results/reference/choices.schema.json. Throws InputError.
inline Json choices_schema() {
  return read_json(installed_folder("results/reference") / "choices.schema.json");
}

// ---- Which input of a sample decides a yes or no

/// For each value the number of its bin, when the values in order are cut into `bins` of equal count; of equal values
/// the first ones come first.
std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins);

/// The first-order Sobol index of an input, Var(E[y | x]) / Var(y), from given data: x is cut into bins (one for each
/// value of a discrete input) and E[y | x] is the mean of y in a bin,
///
///   S = (SSB - (B - 1) SSW / (n - B)) / SST,  SSB = sum_b n_b (mean_b - mean)^2,  SSW = SST - SSB,
///
/// for n points in B bins that are not empty. Without the subtracted term, the mean of SSB when x has no influence,
/// this is the estimator of Plischke, Borgonovo, Smith, "Global sensitivity measures from given data", EJOR 226 (2013)
/// 536-550; with it, Kelley's epsilon squared (1935). May be a little below 0. NaN when y never changes or there are no
/// more points than bins. Precondition: as many bins as values.
double first_order_index(std::span<const std::size_t> bin, std::span<const double> y);

struct DecidingInput {
  std::size_t input = 0;
  double index = 0.0;
};

/// The input with the largest first-order index, if less than `level` of `permutations` random orders of y (seeded)
/// have a largest index as large: the largest of all inputs, so that many inputs do not make a false alarm likely. None
/// when y never changes.
std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level = 0.01,
                                            std::size_t permutations = 999);

// ---- Robustness of the verdicts

/// What is judged again. A reading has one value for each choice.
struct Readings {
  Choices choices;
  PublishedNumbers published;
  std::vector<JudgedClaim> claims;               ///< with the ledger's verdicts
  std::vector<std::vector<std::string>> values;  ///< of each reading, as texts for --set

  /// Costly claims are judged in the first quarter of the readings only.
  std::size_t costly() const { return (values.size() + 3) / 4; }
};

/// The readings of a CSV file: a row each, a column for each choice that it reads otherwise than on record. Throws
/// InputError for a column that is no choice's, a number out of the choice's range and a text that is no option.
std::vector<std::vector<std::string>> read_readings(const std::filesystem::path& file, const Choices& choices);

/// Cells of claims without a verdict: one that could not be measured (a run diverged where its scenario does not expect
/// it, a field refuses the value), and a costly one beyond the readings for those.
inline constexpr const char* kNotMeasured = "error";
inline constexpr const char* kNotJudged = "";

/// A reading's verdict on each claim, by name.
struct ReadingVerdicts {
  std::vector<std::string> verdicts;
  std::vector<std::string> problems;  ///< of the claims that could not be measured, for people
};

/// Judges the claims under one reading. Scenarios run when a claim asks, once, into `directory`, which is removed
/// afterwards. For several threads, with a directory each. Throws IoError.
ReadingVerdicts judge_reading(const Readings& readings, std::size_t reading, const std::filesystem::path& directory);

/// robustness.csv: sample, a column for each choice and one for each claim.
std::string robustness_table(const Readings& readings, const std::vector<ReadingVerdicts>& judged);

/// robustness.json: what the readings' verdicts say of each claim, and the hash of the choices that reach it. Of claims
/// that are not among the readings', it keeps what such a record from before has.
Json robustness_json(const Readings& readings, const std::vector<ReadingVerdicts>& judged, const Json& before);

}  // namespace hapbench
