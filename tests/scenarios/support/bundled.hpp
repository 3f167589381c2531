#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench::test {

/// Returns a scenario that is part of the program, with overrides as in --set.
inline Scenario bundled(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return load_scenario(find_scenario(name), overrides).scenario;
}

/// Runs a scenario and returns the record of every step. The pointers to contact buffers in the records are invalid.
inline std::vector<StepRecord> rows_of(const Scenario& scenario) {
  class Rows final : public Observer {
   public:
    void on_step(const StepRecord& record) noexcept override { rows.push_back(record); }
    std::vector<StepRecord> rows;
  } rows;
  Simulation(simulation_config(scenario), assemble(scenario), {&rows}).run();
  return std::move(rows.rows);
}

}  // namespace hapbench::test
