#include <fmt/format.h>

#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "results/io/atomic_file.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

using AddCommand = void(CommandLine& line);

/// Every command, each defined in a source file of its own subject; those of Python packages stand together.
AddCommand add_compare, add_converge, add_describe, add_limit, add_new, add_python_commands, add_reproduce, add_run,
    add_stress, add_sweep, add_tune, add_validate;

namespace {

constexpr AddCommand* kCommands[] = {add_run,   add_compare,         add_stress,    add_tune,
                                     add_limit, add_converge,        add_reproduce, add_sweep,
                                     add_new,   add_python_commands, add_describe,  add_validate};

/// In the order of the help.
constexpr CommandGuide kGuides[] = {
    {"make",
     "new",
     "a scene to start from",
     {"new", "new drag --from my.stl --extent 12mm --preview", "new hole --out mine.json"}},
    {"make", "import", "my recording as a stroke; my device's log as a device", {}},
    {"make",
     "validate",
     "is a scene right, and what is in it?",
     {"validate mine.json", "validate mine.json --set environment.spacing_m=1e-4",
      "validate drag_molar --points shell.csv"}},
    {"run",
     "run",
     "what happens, what is wrong with it, what to try?",
     {"run drag_molar", "run drag_molar --set rendering.algorithm=proxy --out results/proxy",
      "run mine.json --latency"}},
    {"run",
     "compare",
     "which law does better, over scenes and seeds?",
     {"compare drag_molar", "compare tap_wall tap_corner --algorithms mean,proxy --seeds 5",
      "compare mine.json --algorithms mean,proxy --errors"}},
    {"run",
     "sweep",
     "how does it depend on fields?",
     {"sweep tap_wall --vary rendering.stiffness_N_per_m=1e3:1e5:9:log",
      "sweep tap_wall --vary rendering.algorithm=all --vary seed=1,2,3",
      "sweep results/out/sweep_tap_wall --where 'inside_max_m<3e-4'"}},
    {"decide",
     "limit",
     "how far may a field go, on which device, with which law?",
     {"limit tap_wall --device all", "limit mine.json --algorithms mean,shaped_stiffness",
      "limit tap_wall --vary time.step_s --between 1e-4:1e-2"}},
    {"decide",
     "tune",
     "which law, stiffness and damping?",
     {"tune tap_wall --device touch", "tune mine.json --device log_device.json --algorithms mean,proxy",
      "tune drag_molar --device omega.3 --bound inside_max_m=3e-4"}},
    {"decide",
     "converge",
     "how accurate is a number?",
     {"converge drag_molar --metric force_max_N", "converge mine.json --levels 5 --metric inside_max_m",
      "converge drag_molar --vary environment.spacing_m"}},
    {"decide",
     "stress",
     "does any law break on degenerate contacts?",
     {"stress", "stress --count 1000", "stress --module ./my_law.so"}},
    {"decide",
     "reproduce",
     "which claims of the thesis hold?",
     {"reproduce", "reproduce --only T2,R1b", "reproduce --choices results/reference/readings.csv"}},
    {"look",
     "describe",
     "what is a name? without one: what is there?",
     {"describe", "describe shaped_stiffness", "describe scenarios --grep molar"}},
    {"look", "plot", "a picture of results", {}},
    {"look", "report", "a page of results with replay; of two: what differs", {}},
};

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
  CommandLine line({std::begin(kGuides), std::end(kGuides)},
                   fmt::format("hapbench {} ({})", program.version, program.commit), version_json);
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
    return fail("out of memory; allowed: three quarters of the machine's, or what \"ulimit -d\" sets");
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())));
  }
}

}  // namespace hapbench
