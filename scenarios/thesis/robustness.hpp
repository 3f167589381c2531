#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// Robustness of the verdicts: the claims judged again under other readings of the choices that the thesis leaves open.
namespace hapbench {

/// What is judged again. A reading has one value for each choice.
struct Readings {
  Choices choices;
  PublishedNumbers published;
  std::vector<JudgedClaim> claims;               ///< with the ledger's verdicts
  std::vector<std::vector<std::string>> values;  ///< of each reading, as texts for --set

  /// Costly claims are judged in the first quarter of the readings only.
  std::size_t costly() const { return (values.size() + 3) / 4; }
};

/// Reads the readings of a CSV file: a row each, a column for each choice that it reads otherwise than on record.
/// Throws InputError for a column that is no choice's, a number out of the choice's range and a text that is no option.
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

/// Returns robustness.csv: sample, a column for each choice and one for each claim.
std::string robustness_table(const Readings& readings, const std::vector<ReadingVerdicts>& judged);

/// Returns robustness.json: what the readings' verdicts say of each claim, and the hash of the choices that reach it.
/// Of claims that are not among the readings', it keeps what such a record from before has.
Json robustness_json(const Readings& readings, const std::vector<ReadingVerdicts>& judged, const Json& before);

}  // namespace hapbench
