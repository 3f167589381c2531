#include <csignal>

#include "algorithms/plugin/plugin_call.hpp"
#include "scenarios/input/memory_limit.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/program.hpp"
#include "scenarios/run/stop_signal.hpp"

int main(int argc, char** argv) {
  // Exceeding the file size limit should be an ordinary write error and not terminate the process.
  std::signal(SIGXFSZ, SIG_IGN);
  hapbench::name_plugins_that_end_the_process(hapbench::kInternalFault);
  hapbench::limit_memory({});
  const hapbench::StopSignal signals;
  return hapbench::run_program_to_exit(argc, argv);
}
