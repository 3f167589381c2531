#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scenarios/renderer/open_renderer.hpp"

/// Logs of a haptic loop: one row for every call of hapbench_renderer_step, with inputs and outputs.
namespace hapbench {

/// The scenario that a log was recorded with.
struct LoggedScenario {
  std::string name;
  std::string hash;     ///< scenario_hash()
  double period = 0.0;  ///< [s]
};

/// A log in memory. `inputs` and `outputs` have the same size.
struct LoopLog {
  RendererSetup setup;
  LoggedScenario scenario;
  std::vector<HapbenchInput> inputs;
  std::vector<HapbenchOutput> outputs;
};

/// Returns the first lines of a log: the setup as JSON in a comment, and the names of the columns.
std::string log_header(const RendererSetup& setup, const LoggedScenario& scenario);
/// Returns the line of a log for one call of hapbench_renderer_step. Numbers have 17 digits, so that read_loop_log()
/// returns the same doubles.
std::string log_row(const HapbenchInput& input, const HapbenchOutput& output);

/// Reads a log. Throws InputError with file and line if the file is not a log of this version, or if a call is missing.
/// A log with a missing call cannot be replayed, because forces depend on every earlier call.
LoopLog read_loop_log(const std::filesystem::path& file);

/// Calls hapbench_renderer_step for every input of the log, in order, and returns the outputs. `after_call`: called
/// after each call with its index and its output.
std::vector<HapbenchOutput> replayed(
    HapbenchRenderer& renderer, const LoopLog& log,
    const std::function<void(std::size_t, const HapbenchOutput&)>& after_call = [](auto, const auto&) {});

/// Comparison of two sequences of outputs.
struct ReplayComparison {
  std::size_t calls = 0;
  std::size_t equal = 0;        ///< calls whose outputs are equal to the last bit
  double largest = 0.0;         ///< largest norm, over the calls, of the difference of the forces [N]
  std::size_t first_other = 0;  ///< index of the first call with different outputs; `calls` if all are equal
};
ReplayComparison compare_outputs(const std::vector<HapbenchOutput>& a, const std::vector<HapbenchOutput>& b);

}  // namespace hapbench
