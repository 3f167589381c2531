#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/precision/study.hpp"

namespace hapbench {

/// What `ideal_row` measures.
extern const std::vector<std::string> kIdealColumns;

/// A row of kIdealColumns, and where the run led the tool.
struct IdealRun {
  PrecisionRow row;
  std::vector<Vec3> positions;  ///< of every kContactSetStride-th row [m]
};

/// Errors of a run against the ideal trajectory, over the rows in which the hand is gentle, if it ever is; and the
/// largest change of the force in a step of all rows. Precondition: the scenario is a `drill_in_hole`.
IdealRun ideal_run(std::string setting, const Scenario& scenario, std::shared_ptr<const PointShell> shell,
                   int repetitions);

}  // namespace hapbench
