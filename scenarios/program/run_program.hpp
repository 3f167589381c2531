#pragma once

#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/program_words.hpp"

namespace hapbench {

/// Runs the command of the words behind the program's name and returns the exit status. Says on standard error when a
/// signal (stop_signal.hpp) stopped the work. Throws InputError, also for words that are no command, and IoError.
int run_program(const ProgramWords& words, ProgramContext& context);

/// Does the same, but reports exceptions on standard error: exit status 2 for InputError, 1 for all others.
int run_program_to_exit(const ProgramWords& words, ProgramContext& context);

}  // namespace hapbench
