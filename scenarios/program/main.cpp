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

/// Says which exception nobody caught. oneTBB throws in threads of its own when it can start no further ones.
[[noreturn]] void end_with_a_reason() {
  static std::atomic_flag said;
  while (said.test_and_set()) ::pause();  // another thread ends the process
  std::string what = "an exception of no known type";
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

/// A module that calls exit does not end the program with success.
void refuse_exit() {
  if (main_has_returned) return;
  hapbench::write_error("internal fault: a module or a library called exit");
  std::_Exit(hapbench::kInternalFault);
}

/// Beyond three quarters of the machine's memory an allocation throws std::bad_alloc, so that a file from outside ends
/// in an error and not the machine. Never raises a limit that the system or the user has set.
void limit_memory() {
#ifndef HAPBENCH_SANITIZED  // the sanitizers' own maps of memory, terabytes of addresses, would count
  const auto most = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  rlimit limit = {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur < most / 4 * 3) return;
  limit.rlim_cur = most / 4 * 3;
  ::setrlimit(RLIMIT_DATA, &limit);
#endif
}

/// Keeps memory that was freed for what comes next. glibc would give blocks of megabytes, by which meshes grow, back
/// and fetch them anew page by page: a tenth of the time of a short run on a mesh.
void keep_freed_memory() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // [B], the most that glibc takes
  ::mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  // Exceeding the file size limit should be an ordinary write error and not terminate the process.
  std::signal(SIGXFSZ, SIG_IGN);
  std::atexit(refuse_exit);
  std::set_terminate(end_with_a_reason);
  limit_memory();
  keep_freed_memory();
  const hapbench::StopSignal signals;
  hapbench::ProgramContext context{.program = hapbench::file_of_this_process()};
  const int status = hapbench::run_program_to_exit({argv + std::min(argc, 1), argv + argc}, context);
  main_has_returned = true;
  return status;
}
