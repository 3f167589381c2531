#pragma once

namespace hapbench {

/// Runs the command that argv[1], argv[2], ... name and returns the program's exit status. Reports on standard error
/// when a signal (stop_signal.hpp) stopped the work. Throws InputError, also for words that are no command, and
/// IoError.
int run_program(int argc, char** argv);

/// Does the same, but reports exceptions on standard error: exit status 2 for InputError, 1 for all others.
int run_program_to_exit(int argc, char** argv);

}  // namespace hapbench
