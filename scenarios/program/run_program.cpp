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

/// Prints an error and returns the status of an internal fault.
int fail(std::string_view what, ProgramContext& context) {
  print_error(context, what);
  return kInternalFault;
}

}  // namespace

int run_program(const ProgramArguments& arguments, ProgramContext& context) {
  // Use the C locale while the command runs. The locale of a host such as Python may have a decimal comma.
  const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr), before = ::uselocale(plain);
  const std::shared_ptr<void> restored(nullptr, [=](void*) {
    ::uselocale(before);
    ::freelocale(plain);
  });
  CommandLine line(context);
  try {
    return line.run(arguments);
  } catch (const Stopped& stop) {
    print_note(context, fmt::format("stopped; {}", line.when_stopped()));
    return kStopped + stop.signal;
  }
}

int run_program_to_exit(const ProgramArguments& arguments, ProgramContext& context) {
  try {
    const int status = run_program(arguments, context);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    return fail(fmt::format("cannot write standard output: {}", std::strerror(errno)), context);
  } catch (const InputError& error) {
    print_errors(context, error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what(), context);
  } catch (const std::bad_alloc&) {
    return fail("out of memory; allowed: three quarters of the machine's, or what \"ulimit -d\" sets", context);
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())), context);
  }
}

}  // namespace hapbench
