#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "results/io/io_error.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

int fail(const char* kind, const char* what, int status) {
  fmt::print(stderr, "hapbench: {}: {}\n", kind, what);
  return status;
}

int run_program(int argc, char** argv) {
  const Provenance program = provenance();
  CommandLine line(fmt::format("hapbench {} ({})", program.version, program.commit));
  add_run(line);
  add_compare(line);
  add_stability(line);
  add_limit(line);
  add_precision(line);
  add_reproduce(line);
  add_diff(line);
  add_sweep(line);
  add_merge(line);
  add_new(line);
  add_plot(line);
  add_report(line);
  add_shell(line);
  add_list(line);
  add_describe(line);
  add_validate(line);
  const StopSignal signals;
  try {
    return line.run(argc, argv);
  } catch (const Stopped& stop) {
    fmt::print(stderr, "hapbench: stopped; {}\n", line.when_stopped());
    return kStopped + stop.signal;
  }
}

}  // namespace
}  // namespace hapbench

int main(int argc, char** argv) {
  using namespace hapbench;
  // Exceeding the file size limit should be an ordinary write error and not terminate the process.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run_program(argc, argv);
  } catch (const InputError& error) {
    return fail("error", error.what(), kBadInput);
  } catch (const IoError& error) {
    return fail("error", error.what(), kInternalFault);
  } catch (const std::bad_alloc&) {
    return fail("error", "out of memory", kInternalFault);
  } catch (const std::exception& error) {
    return fail("internal fault", error.what(), kInternalFault);
  }
}
