#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <string>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/run_program.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace {

/// Terminate handler: reports the uncaught exception and exits. oneTBB throws in its own threads if it cannot
/// start further threads.
[[noreturn]] void report_uncaught_exception() {
  static std::atomic_flag is_reporting;
  while (is_reporting.test_and_set()) ::pause();  // only the first thread reports; it ends the process
  std::string what = "an exception of unknown type";
  try {
    if (const auto uncaught = std::current_exception()) std::rethrow_exception(uncaught);
  } catch (const std::exception& error) {
    what = error.what();
  } catch (...) {
  }
  hapbench::write_error(
      hapbench::one_line(fmt::format("internal fault: {}; if threads or memory ran short: fewer --jobs", what)));
  std::quick_exit(hapbench::kInternalFault);
}

std::atomic<bool> main_has_returned{false};

/// Exit handler: a module that calls exit must not end the program with the status of success.
void refuse_exit() {
  if (main_has_returned) return;
  hapbench::write_error("internal fault: a module or a library called exit");
  std::_Exit(hapbench::kInternalFault);
}

/// Limits the memory of this process to three quarters of the machine's memory. Beyond the limit, an allocation
/// throws std::bad_alloc, so that an excessive input file ends in an error and does not stall the machine.
/// Never raises a limit that the system or the user has set.
void limit_memory() {
#ifndef HAPBENCH_SANITIZED  // the sanitizers map terabytes of addresses, which would count
  const auto memory = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  rlimit limit = {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur < memory / 4 * 3) return;
  limit.rlim_cur = memory / 4 * 3;
  ::setrlimit(RLIMIT_DATA, &limit);
#endif
}

/// Makes glibc keep freed memory for later allocations. By default glibc returns blocks of some megabytes to the
/// system and requests them again page by page. The arrays of a mesh that is being read are such blocks. Without this
/// function, a short run on a mesh would take about a tenth longer.
void keep_freed_memory() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // [B], the largest value that glibc accepts
  ::mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  // If SIGXFSZ were not ignored, a file larger than the limit would terminate the process. It should only cause a
  // write error.
  std::signal(SIGXFSZ, SIG_IGN);
  std::atexit(refuse_exit);
  std::set_terminate(report_uncaught_exception);
  limit_memory();
  keep_freed_memory();
  const hapbench::StopSignal signals;
  hapbench::ProgramContext context{.program = hapbench::file_of_this_process()};
  const int status = hapbench::run_program_to_exit({argv + std::min(argc, 1), argv + argc}, context);
  main_has_returned = true;
  return status;
}
