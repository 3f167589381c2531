#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/input_error.hpp"

/// Names the file that a field of a scenario comes from, in errors and warnings.
namespace hapbench {

struct LoadedScenario;

/// The file that the value at a JSON pointer comes from: the scenario's own, or one that it extends.
std::filesystem::path file_of(const LoadedScenario& loaded, const std::string& pointer);

/// The warnings with the file and the pointer of each in front, for people.
std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings);

/// Throws the error again with the file in front of each fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const std::filesystem::path& file);
/// The same with the scenario's file, or the one it extends that has the fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const LoadedScenario& loaded);

/// Calls `work` and throws an InputError of it again as rethrow_with_file does with a file or a loaded scenario.
template <class Place, class Work>
auto with_file(const Place& place, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    rethrow_with_file(error, place);
  }
}

}  // namespace hapbench
