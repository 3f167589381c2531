#include <fmt/format.h>

#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>

#include "results/io/atomic_file.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/memory_limit.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

using AddCommand = void(CommandLine& line);

/// Every command, each defined in a source file of its own subject; those of Python packages stand together. The second
/// list is in the order of the help.
AddCommand add_compare, add_converge, add_describe, add_limit, add_new, add_python_commands, add_reproduce, add_run,
    add_stress, add_sweep, add_tune, add_validate;

namespace {

constexpr AddCommand* kCommands[] = {add_run,   add_compare,         add_stress,    add_tune,
                                     add_limit, add_converge,        add_reproduce, add_sweep,
                                     add_new,   add_python_commands, add_describe,  add_validate};

/// The promise of a version.
constexpr const char* kPromise =
    "Within a major version (before 1.0: a minor one) no field of scenarios, no file or column of results, no command, "
    "option or exit status goes away or changes its meaning; there may be more of them. Computed numbers may change with "
    "every version: results name the commit that made them.";

std::string version_json() {
  const Provenance program = provenance();
  const InstructionSet set = instruction_set();
  return Json({{"version", program.version},
               {"commit", program.commit},
               {"compiler", program.compiler},
               {"build_type", program.build_type},
               {"flags", program.flags},
               {"instruction_set", {{"march", set.march}, {"widest", set.widest}, {"simd", set.simd}}},
               {"promise", kPromise}})
      .dump(2);
}

int fail(std::string_view what) {
  print_error(what);
  return kInternalFault;
}

/// Numbers are read and written without the language of a host such as Python, whose decimal point may be a comma.
class PlainNumbers {
 public:
  PlainNumbers() : plain_(::newlocale(LC_ALL_MASK, "C", nullptr)), before_(::uselocale(plain_)) {}
  ~PlainNumbers() {
    ::uselocale(before_);
    ::freelocale(plain_);
  }
  PlainNumbers(const PlainNumbers&) = delete;
  PlainNumbers& operator=(const PlainNumbers&) = delete;

 private:
  locale_t plain_, before_;
};

}  // namespace

int run_program(int argc, char** argv) {
  const PlainNumbers plain_numbers;
  const Provenance program = provenance();
  CommandLine line(fmt::format("hapbench {} ({})", program.version, program.commit), version_json);
  for (AddCommand* add_command : kCommands) add_command(line);
  try {
    return line.run(argc, argv);
  } catch (const Stopped& stop) {
    print_note(fmt::format("stopped; {}", line.when_stopped()));
    return kStopped + stop.signal;
  }
}

int run_program_to_exit(int argc, char** argv) {
  try {
    const int status = run_program(argc, argv);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    return fail(fmt::format("cannot write standard output: {}", std::strerror(errno)));
  } catch (const InputError& error) {
    print_errors(error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory; allowed: " + memory_limit_text());
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())));
  }
}

}  // namespace hapbench
