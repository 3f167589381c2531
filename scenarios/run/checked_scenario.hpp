#pragma once

#include <utility>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// A scenario whose named files are known to be usable. Only checked() makes one, so that a function that runs a
/// CheckedScenario cannot be called before the check, and no scenario is checked twice.
///
/// A scenario that is built in code without files is checked in the same way, for which checked() then has nothing to
/// do. An experiment that needs parts of its own, such as another observer, calls assemble() and steps a Simulation.
class CheckedScenario {
 public:
  const LoadedScenario& loaded() const { return loaded_; }
  const Scenario& scenario() const { return loaded_.scenario; }
  const NamedFiles& files() const { return loaded_.files; }
  /// Warnings about the files: a mesh that is open or was mended, and a stroke at other times than the run.
  const std::vector<Warning>& file_warnings() const { return file_warnings_; }

 private:
  CheckedScenario(LoadedScenario loaded, std::vector<Warning> file_warnings)
      : loaded_(std::move(loaded)), file_warnings_(std::move(file_warnings)) {}
  friend CheckedScenario checked(LoadedScenario loaded);

  LoadedScenario loaded_;
  std::vector<Warning> file_warnings_;
};

/// Reads and parses the files that the scenario names, and loads its library of contacts, so that faults in them are
/// found before anything is written. Cost: that of reading; some microseconds for each file that this process has read
/// before and that has not changed. Throws InputError.
CheckedScenario checked(LoadedScenario loaded);

}  // namespace hapbench
