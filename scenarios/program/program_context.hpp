#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/program/layout.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/new_directories.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// The captured output of a command.
struct CapturedOutput {
  std::string text;                           ///< text of standard output
  std::vector<std::string> warnings, errors;  ///< lines of standard error; notes are among the warnings
};

/// State that a command shares with the program that runs it. The function main and hosts such as the Python
/// module create it. It is passed to functions that print, that name the program, or that create result
/// folders. Loaded modules (load_module.hpp) and the stop signal (stop_signal.hpp) are not part of it, because
/// they belong to the process; these two headers give the reasons.
struct ProgramContext {
  std::filesystem::path program;       ///< executable file, named in printed commands and called by Python packages
  CapturedOutput* captured = nullptr;  ///< receives printed text for a host without a terminal; null: text is printed
  bool in_full = false;                ///< true if the option --wide was given
  const ProgressListener* progress = nullptr;  ///< receives progress instead of the terminal; null: draws bars
  LoadingGuard guard_loading = {};             ///< called before a module is loaded, for a host with threads of its own
  NewDirectories directories = {};  ///< created result folders; the destructor removes the folders that are still empty

  /// Returns the layout of standard output at its current width.
  Layout layout() const;
};

/// Returns the executable file of this process; empty if the system does not provide it.
std::filesystem::path file_of_this_process();

}  // namespace hapbench
