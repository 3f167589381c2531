#pragma once

#include <utility>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// Selects whether checked() loads or only inspects the library of contacts that a scenario names. An inspected library
/// is not loaded, and the scenario cannot be run.
enum class Libraries { loaded, inspected };

/// A scenario whose named files are known to be usable. Only checked() creates an instance. A function that
/// takes a CheckedScenario therefore cannot be called with an unchecked scenario, and no scenario is checked
/// twice.
///
/// A scenario that is built in code without files also passes through checked(), which then has nothing to
/// check. An experiment that needs other parts, such as another observer, calls assemble() and steps a
/// Simulation itself.
class CheckedScenario {
 public:
  const LoadedScenario& loaded() const { return loaded_; }
  const Scenario& scenario() const { return loaded_.scenario; }
  const NamedFiles& files() const { return loaded_.files; }
  /// Warnings about the files: a mesh that is open or was repaired, columns of a table that are not used, or a
  /// recording whose clock does not fit the run.
  const std::vector<Warning>& file_warnings() const { return file_warnings_; }

 private:
  CheckedScenario(LoadedScenario loaded, std::vector<Warning> file_warnings)
      : loaded_(std::move(loaded)), file_warnings_(std::move(file_warnings)) {}
  friend CheckedScenario checked(LoadedScenario loaded, Libraries libraries);

  LoadedScenario loaded_;
  std::vector<Warning> file_warnings_;
};

/// Reads and parses the files that the scenario names, and loads its library of contacts, so that errors are
/// found before any result is written. Cost: reading the files; a few microseconds for each file that this
/// process has already read and that has not changed since. Throws InputError if a file cannot be used, or if the user
/// has not permitted the library (load_module.hpp).
CheckedScenario checked(LoadedScenario loaded, Libraries libraries = Libraries::loaded);

}  // namespace hapbench
