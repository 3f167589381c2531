#include "scenarios/program/run_program.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command_line.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

namespace {

int fail(std::string_view what) {
  print_error(what);
  return kInternalFault;
}

}  // namespace

int run_program(const ProgramWords& words) {
  // Numbers are read and written without the language of a host such as Python, whose decimal point may be a comma.
  const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr), before = ::uselocale(plain);
  const std::shared_ptr<void> restored(nullptr, [=](void*) {
    ::uselocale(before);
    ::freelocale(plain);
  });
  CommandLine line;
  try {
    return line.run(words);
  } catch (const Stopped& stop) {
    print_note(fmt::format("stopped; {}", line.when_stopped()));
    return kStopped + stop.signal;
  }
}

int run_program_to_exit(const ProgramWords& words) {
  try {
    const int status = run_program(words);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    return fail(fmt::format("cannot write standard output: {}", std::strerror(errno)));
  } catch (const InputError& error) {
    print_errors(error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory; allowed: three quarters of the machine's, or what \"ulimit -d\" sets");
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())));
  }
}

std::filesystem::path& this_program() {
  std::error_code ignored;
  static std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return program;
}

}  // namespace hapbench
