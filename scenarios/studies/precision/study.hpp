#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/description/scenario.hpp"

/// Run time against error: one row per setting of one thing (a time step, a number of iterations, an algorithm), with
/// its error against a reference, or what it asks for, and the time it takes.
namespace hapbench {

/// One setting. Failures are rows like the others, with what failed as outcome.
struct PrecisionRow {
  std::string setting;
  std::string outcome;
  std::vector<std::optional<double>> values;  ///< one for each column of the study; none where there is none
  double seconds = 0.0;  ///< of one step or call: the least of the repetitions, timed apart from the errors
};

/// A line log(error) = order log(x) + c fitted to the rows of one series.
struct FittedOrder {
  std::string series;
  std::string error;  ///< name of the column
  double order = 0.0;
};

struct PrecisionResult {
  std::vector<std::string> columns;  ///< names with units
  std::string timed;                 ///< what `seconds` are of: "step" or "call"
  std::vector<PrecisionRow> rows;
  std::vector<FittedOrder> orders;
};

struct PrecisionOptions {
  int repetitions = 5;
  std::function<void(std::size_t done, std::size_t all)> progress = [](std::size_t, std::size_t) {};
};

struct PrecisionStudy {
  const char* name;
  const char* summary;
  const char* scenario;  ///< name of the bundled scenario it starts from
  /// Throws InputError when the scenario is not of the kind the study needs.
  PrecisionResult (*run)(const Scenario& scenario, const PrecisionOptions& options);
};

// The table. Each row is defined beside its study; adding one is its file and two lines here.
extern const PrecisionStudy kIntegratorsStudy;
extern const PrecisionStudy kTimeStepStudy;
extern const PrecisionStudy kShapingStudy;
extern const PrecisionStudy kSpacingStudy;
extern const PrecisionStudy kReductionStudy;
extern const PrecisionStudy kMergingStudy;
extern const PrecisionStudy kAlgorithmsStudy;
extern const PrecisionStudy kStiffnessStudy;
extern const PrecisionStudy kQueryTimeStudy;
extern const PrecisionStudy kContactSourcesStudy;

inline constexpr std::array kPrecisionStudies = {
    &kIntegratorsStudy, &kTimeStepStudy,   &kShapingStudy,   &kSpacingStudy,   &kReductionStudy,
    &kMergingStudy,     &kAlgorithmsStudy, &kStiffnessStudy, &kQueryTimeStudy, &kContactSourcesStudy};

}  // namespace hapbench
