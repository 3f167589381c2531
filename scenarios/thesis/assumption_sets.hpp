#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// Judges claims under other assumptions. An assumption set has one value for each assumption that the thesis leaves
/// open (assumptions.hpp).
namespace hapbench {

/// One value for each assumption.
struct AssumptionSet {
  std::vector<std::string> values;   ///< values[assumption], as texts for --set
  std::set<std::size_t> given = {};  ///< assumptions whose value is given, so that it is not calibrated
};

/// Reads assumption sets from a CSV file, with one row for each set and one column for each assumption whose value the
/// file gives. Other assumptions have their recorded values, or calibrated values (calibrated()). Throws InputError for
/// a column that is not an assumption, a number outside of the assumption's range, or a text that is not one of its
/// options.
std::vector<AssumptionSet> read_assumption_sets(const std::filesystem::path& file, const Assumptions& assumptions);

/// Returns the assumptions whose values differ from the recorded values, in the form "servo.delay = 2, local.average =
/// false"; "as recorded" if no value differs.
std::string difference_text(const AssumptionSet& set, const Assumptions& assumptions);

/// An assumption counts as calibrated if the number of raw points (colliding points) differs from the published number
/// by at most this fraction.
inline constexpr double kCalibrationTolerance = 0.03;

/// An assumption set whose calibrated assumptions have the values that give the published numbers of raw points.
struct CalibratedSet {
  AssumptionSet set;
  std::set<std::size_t> missed = {};  ///< assumptions that could not be calibrated within their range
};

/// Calibrates the inputs of a set, that is, the assumptions that have an Assumption::calibration. Leaves an input
/// unchanged if its value is given, or if no other assumption of the set changes the scenario of its calibration. Uses
/// the secant method on logarithms of the values, starts at the recorded value, and makes at most 8 runs for each
/// input. Throws InputError if a scenario of a calibration cannot run.
CalibratedSet calibrated(AssumptionSet set, const Assumptions& assumptions);

/// Inputs with which the claims are judged.
struct JudgingInputs {
  const Assumptions& assumptions;
  const PublishedNumbers& published;  ///< without the values of assumptions
};

/// The verdict on a claim under an assumption set.
struct SetFinding {
  std::string verdict;                 ///< verdict_name(), or kNotMeasured
  std::string number;                  ///< Finding::number; empty if the claim was not measured
  std::string why;                     ///< Finding::why, or why the claim was not measured
  std::vector<std::string> scenarios;  ///< names of the scenarios that were used
  /// Verdict of the earlier rule; empty if the claim has no earlier rule. The earlier rules know no calibration, so it
  /// is a verdict also if an input could not be calibrated.
  std::string earlier = {};
};
/// Verdict of a claim that could not be measured: a run diverged unexpectedly, or a field refuses the value.
inline constexpr const char* kNotMeasured = "not measured";

/// Judges the claims under a set. Runs each scenario once, when a claim first needs it. A claim has the verdict "not
/// judged" if it uses the scenario of an input that could not be calibrated. Writes results into `directory` and
/// removes this directory at the end. Thread-safe if each call has a different directory. Throws IoError if results
/// cannot be written.
std::vector<SetFinding> judge_set(const JudgingInputs& inputs, const CalibratedSet& calibrated,
                                  const std::vector<Claim>& claims, const std::filesystem::path& directory);

}  // namespace hapbench
