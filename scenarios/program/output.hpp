#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/checked_scenario.hpp"

/// Prints results and messages on standard output and standard error, or stores them in
/// ProgramContext::captured if the context has it.
namespace hapbench {

/// Prints `text`, wrapped to the width of the output. Prints `json` instead under --json, and nothing under
/// --quiet.
void print(const ProgramContext& context, const OutputOptions& options, const std::string& text, const Json& json);
/// Prints the tables in the format of --table, and nothing else, on standard output. Prints a note if there are several
/// CSV tables, because readers of CSV files expect a single table. Throws InputError if there is no table.
/// Precondition: options.table is not empty.
void print_tables(const ProgramContext& context, const OutputOptions& options, std::span<const Table> tables);
/// Prints warnings, one line each, on standard error.
void print_warnings(const ProgramContext& context, const std::vector<std::string>& warnings);
/// Prints the warnings about a scenario, each with its file in front: first the warnings about fields, then the
/// warnings about the files that the scenario names.
void print_warnings(const ProgramContext& context, const CheckedScenario& checked);
/// Prints "hapbench: TEXT" on standard error.
void print_note(const ProgramContext& context, std::string_view text);
/// Prints "hapbench: error: TEXT" on standard error.
void print_error(const ProgramContext& context, std::string_view text);
/// Prints each fault of an InputError as an error line.
void print_errors(const ProgramContext& context, const InputError& error);
/// Prints "hapbench: error: TEXT" on standard error, even if a host captures the output of commands.
void write_error(std::string_view text);

}  // namespace hapbench
