#include "scenarios/program/program.hpp"

#include <fmt/format.h>

#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>

#include "results/io/atomic_file.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

int fail(std::string_view what, int status) {
  print_error(what);
  return status;
}

/// What a version stands for.
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

}  // namespace

int run_program(int argc, char** argv) {
  const Provenance program = provenance();
  CommandLine line(fmt::format("hapbench {} ({})", program.version, program.commit), version_json);
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
  add_import(line);
  add_plot(line);
  add_report(line);
  add_shell(line);
  add_list(line);
  add_describe(line);
  add_validate(line);
  add_completion(line);
  add_man(line);
  try {
    return line.run(argc, argv);
  } catch (const Stopped& stop) {
    print_note(fmt::format("stopped; {}", line.when_stopped()));
    return kStopped + stop.signal;
  }
}

int run_program_to_exit(int argc, char** argv) {
  try {
    return run_program(argc, argv);
  } catch (const InputError& error) {
    print_errors(error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what(), kInternalFault);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kInternalFault);
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())), kInternalFault);
  }
}

}  // namespace hapbench
