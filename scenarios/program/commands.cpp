#include "scenarios/program/commands.hpp"

#include "scenarios/program/compare/compare.hpp"
#include "scenarios/program/converge.hpp"
#include "scenarios/program/describe/describe.hpp"
#include "scenarios/program/limit/limit.hpp"
#include "scenarios/program/new/new.hpp"
#include "scenarios/program/reproduce.hpp"
#include "scenarios/program/run.hpp"
#include "scenarios/program/stress.hpp"
#include "scenarios/program/sweep.hpp"
#include "scenarios/program/tune/tune.hpp"
#include "scenarios/program/validate.hpp"

namespace hapbench {

namespace {

/// The commands in the order of the help.
constexpr CommandGuide kCommands[] = {
    {"make", "new", "write a scenario to start from", add_new,
     "new\n"
     "new drag --from my.stl --extent 12mm --preview\n"
     "new hole --out mine.json",
     "scenarios/README.md, section \"Write a scenario\""},
    {"make", "import", "turn a recording into a stroke, a log into a device file", nullptr},
    {"make", "validate", "check scenarios and show size, points and duration", add_validate,
     "validate mine.json\n"
     "validate mine.json --set environment.spacing_m=1e-4\n"
     "validate drag_molar --points shell.csv",
     "scenarios/INPUT_FILES.md"},
    {"run", "run", "run scenarios and diagnose the results", add_run,
     "run drag_molar\n"
     "run drag_molar --set rendering.algorithm=proxy --out results/proxy\n"
     "run mine.json --latency\n"
     "run mine.json --replay loop.csv",
     "results/README.md, section \"Files of a run\""},
    {"run", "compare", "compare force laws, rank them over scenarios and seeds", add_compare,
     "compare drag_molar\n"
     "compare tap_wall --algorithms mean,proxy --seeds 5 --jitter 1e-5\n"
     "compare mine.json --algorithms mean,proxy --errors",
     "scenarios/batch/README.md, section \"Comparisons\""},
    {"run", "sweep", "run a grid or a sample of field values", add_sweep,
     "sweep tap_wall --vary rendering.stiffness_N_per_m=1e3:1e5:9:log\n"
     "sweep tap_wall --vary rendering.algorithm=all --vary seed=1,2,3\n"
     "sweep results/out/sweep_tap_wall --where 'inside_max_m<3e-4'",
     "scenarios/batch/README.md, section \"Sweeps\""},
    {"decide", "limit", "find the largest value of a field at which runs are stable", add_limit,
     "limit tap_wall --device all\n"
     "limit mine.json --algorithms mean,shaped_stiffness\n"
     "limit tap_wall --vary time.step_s --between 1e-4:1e-2",
     "scenarios/LIMITS.md, section \"How limit searches\""},
    {"decide", "tune", "choose force law, stiffness and damping for a device", add_tune,
     "tune tap_wall --device touch\n"
     "tune mine.json --device log_device.json --algorithms mean,proxy\n"
     "tune tap_wall --device omega.3 --bound inside_max_m=1.5e-3",
     "scenarios/TUNING.md, section \"What tune searches\""},
    {"decide", "converge", "estimate the discretization error of a metric", add_converge,
     "converge drag_molar --metric force_max_N\n"
     "converge mine.json --levels 5 --metric inside_max_m\n"
     "converge drag_molar --vary environment.spacing_m\n"
     "converge drag_molar --over integrator.type=all --to 1e-6",
     "scenarios/ACCURACY.md"},
    {"decide", "stress", "test every force law on degenerate contacts", add_stress,
     "stress\n"
     "stress --count 1000\n"
     "stress --module ./my_law.so",
     "scenarios/STRESS.md"},
    {"decide", "reproduce", "test the claims of the thesis", add_reproduce,
     "reproduce\n"
     "reproduce --only T2,R1b\n"
     "reproduce --only J1 --assumptions other.csv",
     "scenarios/thesis/README.md, section \"The command reproduce\""},
    {"look", "describe", "explain a name, or list what exists", add_describe,
     "describe\n"
     "describe shaped_stiffness\n"
     "describe scenarios --grep molar",
     "scenarios/README.md, section \"Commands\""},
    {"look", "audit", "report energy, vibration and stiffness in a log of any engine", nullptr},
    {"look", "plot", "draw results as a picture", nullptr},
    {"look", "report", "play back runs on a web page, or compare two folders", nullptr}};

}  // namespace

std::span<const CommandGuide> command_guides() {
  return kCommands;
}

}  // namespace hapbench
