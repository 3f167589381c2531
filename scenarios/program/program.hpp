#pragma once

namespace hapbench {

/// Runs the command that the words of the command line name, the first one aside, and returns the program's exit
/// status; work that stop_signal.hpp stopped is told of on standard error. Throws InputError, also for words that are
/// no command, and IoError.
int run_program(int argc, char** argv);

/// The same, with what it throws said on standard error: exit status 2 for InputError, 1 for all else.
int run_program_to_exit(int argc, char** argv);

}  // namespace hapbench
