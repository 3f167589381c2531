#pragma once

#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// Runs the command that the arguments name and returns the exit status. If a signal (stop_signal.hpp) stops
/// the work, prints a note on standard error. Throws IoError, and InputError for bad input and for an unknown
/// command.
int run_program(const ProgramArguments& arguments, ProgramContext& context);

/// Calls run_program() and reports exceptions on standard error. Returns exit status 2 for InputError and 1 for
/// other exceptions.
int run_program_to_exit(const ProgramArguments& arguments, ProgramContext& context);

}  // namespace hapbench
