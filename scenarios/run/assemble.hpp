#pragma once

#include <vector>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/make_shell.hpp"
#include "scenarios/run/make_tool.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Reads and parses the files the scenario names, so that what is wrong with them is found before anything is written;
/// `loaded.files` keeps them for the run. Returns warnings about what is odd, each with file and pointer. Throws
/// InputError.
std::vector<std::string> check_named_files(const LoadedScenario& loaded);

/// The same warnings with the pointer alone in front, as results keep them: equal wherever the files lie. Precondition:
/// the files can be used.
std::vector<std::string> named_file_warnings(const LoadedScenario& loaded);

/// Numbers of the run.
SimulationConfig simulation_config(const Scenario& scenario);

/// One run of a scenario that has several: a simulated subject's trial. Both count from 0.
struct Trial {
  std::size_t subject = 0;
  std::size_t number = 0;
};

/// Everything the run is made of. Precondition: `shell` is make_shell of this scenario. Throws InputError when a named
/// file cannot be used. With skips off (RenderingConfig), every step compares every point with the tool.
SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial);
/// The same, reading the scenario's files.
SimulationParts assemble(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial);
/// The only or first run, with a shell of its own.
SimulationParts assemble(const Scenario& scenario);

}  // namespace hapbench
