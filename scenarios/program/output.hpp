#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/run/checked_scenario.hpp"

/// What commands print: on standard output and standard error, or for the host that the context names.
namespace hapbench {

/// Prints `text`, as wide as the output is, or `json` under --json, or nothing under --quiet.
void print(const ProgramContext& context, const OutputOptions& options, const std::string& text, const Json& json);
/// Prints warnings, one line each, on standard error.
void print_warnings(const ProgramContext& context, const std::vector<std::string>& warnings);
/// Prints those about a scenario, given values first, then files, with the file of each in front.
void print_warnings(const ProgramContext& context, const CheckedScenario& checked);
/// Prints "hapbench: TEXT" on standard error.
void print_note(const ProgramContext& context, std::string_view text);
/// Prints "hapbench: error: TEXT" on standard error.
void print_error(const ProgramContext& context, std::string_view text);
/// Prints each fault of bad input as an error.
void print_errors(const ProgramContext& context, const InputError& error);
/// Prints "hapbench: error: TEXT" on standard error, whoever collects what commands print.
void write_error(std::string_view text);

}  // namespace hapbench
