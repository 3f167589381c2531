#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// Prints `text`, as wide as the output is, or `json` under --json, or nothing under --quiet.
void print(const OutputOptions& options, const std::string& text, const Json& json);
/// Prints warnings, one line each, on standard error.
void print_warnings(const std::vector<std::string>& warnings);
/// Prints those about a scenario, given values first, then files, with the file of each in front.
void print_warnings(const LoadedScenario& loaded);
/// Prints "hapbench: TEXT" on standard error.
void print_note(std::string_view text);
/// Prints "hapbench: error: TEXT" on standard error.
void print_error(std::string_view text);
/// Prints each fault of bad input as an error.
void print_errors(const InputError& error);

/// The output of a command.
struct CapturedOutput {
  std::string text;                           ///< of standard output
  std::vector<std::string> warnings, errors;  ///< notes are among the warnings
};

/// The object that collects what the commands of this thread print, for a host that is not a terminal; null: none does.
CapturedOutput*& captured_output() noexcept;

}  // namespace hapbench
