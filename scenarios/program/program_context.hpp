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

/// The output of a command.
struct CapturedOutput {
  std::string text;                           ///< of standard output
  std::vector<std::string> warnings, errors;  ///< notes are among the warnings
};

/// What a command has of the program that runs it. `main` makes it, as does a host such as the Python module, and it is
/// passed to whoever prints, names the program or creates folders of results. The loaded modules (load_module.hpp) and
/// the signal to stop (stop_signal.hpp) belong to the process and are not in it; the comments there say why.
struct ProgramContext {
  std::filesystem::path program;       ///< file of the program, which printed commands and the Python packages name
  CapturedOutput* captured = nullptr;  ///< collects what commands print, for a host that is not a terminal; null: none
  bool in_full = false;                ///< the option --wide
  const ProgressListener* progress = nullptr;  ///< hears of progress in place of the terminal; null: bars are drawn
  LoadingGuard guard_loading = {};             ///< called before a law is loaded, for a host with threads of its own
  NewDirectories directories = {};             ///< of results; those that are still empty leave with this object

  /// As wide as standard output is now.
  Layout layout() const;
};

/// The file of the program that this process runs; empty where the system does not tell.
std::filesystem::path file_of_this_process();

}  // namespace hapbench
