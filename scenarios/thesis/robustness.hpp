#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// Robustness of the verdicts: the claims are judged again under other readings of the thesis. A reading assigns one
/// value to each choice (choices.hpp) that the thesis leaves open.
namespace hapbench {

/// The claims and the readings under which they are judged.
struct Readings {
  Choices choices;
  PublishedNumbers published;
  std::vector<JudgedClaim> claims;               ///< the claims with the verdicts of the ledger
  std::vector<std::vector<std::string>> values;  ///< values[reading][choice], as texts for --set

  /// Returns the number of readings for costly claims, which are judged in the first quarter of the readings only.
  std::size_t costly() const { return (values.size() + 3) / 4; }
};

/// Reads the readings from a CSV file, with one row for each reading and one column for each choice that varies. Other
/// choices have their recorded values. Throws InputError for a column that is not a choice, a number outside of the
/// choice's range, or a text that is not an option of the choice.
std::vector<std::vector<std::string>> read_readings(const std::filesystem::path& file, const Choices& choices);

// Cells of claims without a verdict.

/// The claim could not be measured: a run diverged unexpectedly, or a field does not allow the value.
inline constexpr const char* kNotMeasured = "error";
/// The claim is costly, and the reading is not among the first costly() readings.
inline constexpr const char* kNotJudged = "";

/// The verdicts on all claims under one reading.
struct ReadingVerdicts {
  std::vector<std::string> verdicts;  ///< verdict_name(), kNotMeasured or kNotJudged, by claim
  std::vector<std::string> problems;  ///< texts that explain why claims could not be measured
};

/// Judges the claims under one reading. Runs each scenario once, when a claim first needs it. Writes results into
/// `directory` and removes the directory at the end. Thread-safe if each call has its own directory. Throws IoError.
ReadingVerdicts judge_reading(const Readings& readings, std::size_t reading, const std::filesystem::path& directory);

/// Returns the content of robustness.csv: the number of the reading ("sample"), a column for each choice, and a column
/// with the verdict on each claim.
std::string robustness_table(const Readings& readings, const std::vector<ReadingVerdicts>& judged);

/// Returns the content of robustness.json: for each claim, counts of its verdicts over the readings, and the hash of
/// the choices that influence it. Entries of `before`, an earlier robustness.json, are kept for claims that are not
/// among the claims of `readings`.
Json robustness_json(const Readings& readings, const std::vector<ReadingVerdicts>& judged, const Json& before);

}  // namespace hapbench
