#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/run_sweep.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Sweeps to test with.
namespace hapbench::test {

inline SweepPlan plan_of(const Json& scenario, const std::vector<std::string>& vary,
                         const std::filesystem::path& file = data_directory() / "sweep.json") {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text));
  return plan_sweep({file, scenario}, {}, SweepPoints(axes), 2, false);
}

}  // namespace hapbench::test
