#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/input_error.hpp"

/// Names the file that sets a scenario field, in errors and warnings about this field.
namespace hapbench {

struct LoadedScenario;

/// Returns the file that sets the value at a JSON pointer: the scenario's file, or a file that it extends. If no
/// file sets the value, returns the file that has the nearest enclosing object.
std::filesystem::path file_of(const LoadedScenario& loaded, const std::string& pointer);

/// Returns the warnings as texts for the user. Each text begins with the location of the value: the file that sets it
/// and the JSON pointer of the value, or, if an override sets this field, the name of the scenario and the path of the
/// field.
std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings);

/// Throws a copy of `error`. In the copy, the name of `file` stands in front of each fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const std::filesystem::path& file);
/// Throws a copy of `error`. In the copy, the name of the file that has the fault stands in front of each fault. This
/// file is the scenario's file, or a file that it extends.
[[noreturn]] void rethrow_with_file(const InputError& error, const LoadedScenario& loaded);

/// Calls `work` and returns its result. An InputError that `work` throws is passed to rethrow_with_file with
/// `source`, which is a file or a loaded scenario.
template <class Source, class Work>
auto with_file(const Source& source, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    rethrow_with_file(error, source);
  }
}

}  // namespace hapbench
