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
    {"make", "new", "a scene to start from", add_new,
     "new\n"
     "new drag --from my.stl --extent 12mm --preview\n"
     "new hole --out mine.json"},
    {"make", "import", "my recording as a stroke; my device's log as a device", nullptr},
    {"make", "validate", "is a scene right, and what is in it?", add_validate,
     "validate mine.json\n"
     "validate mine.json --set environment.spacing_m=1e-4\n"
     "validate drag_molar --points shell.csv"},
    {"run", "run", "what happens, what is wrong with it, what to try?", add_run,
     "run drag_molar\n"
     "run drag_molar --set rendering.algorithm=proxy --out results/proxy\n"
     "run mine.json --latency"},
    {"run", "compare", "which law does better, over scenes and seeds?", add_compare,
     "compare drag_molar\n"
     "compare tap_wall tap_corner --algorithms mean,proxy --seeds 5\n"
     "compare mine.json --algorithms mean,proxy --errors"},
    {"run", "sweep", "how does it depend on fields?", add_sweep,
     "sweep tap_wall --vary rendering.stiffness_N_per_m=1e3:1e5:9:log\n"
     "sweep tap_wall --vary rendering.algorithm=all --vary seed=1,2,3\n"
     "sweep results/out/sweep_tap_wall --where 'inside_max_m<3e-4'"},
    {"decide", "limit", "how far may a field go, on which device, with which law?", add_limit,
     "limit tap_wall --device all\n"
     "limit mine.json --algorithms mean,shaped_stiffness\n"
     "limit tap_wall --vary time.step_s --between 1e-4:1e-2"},
    {"decide", "tune", "which law, stiffness and damping?", add_tune,
     "tune tap_wall --device touch\n"
     "tune mine.json --device log_device.json --algorithms mean,proxy\n"
     "tune drag_molar --device omega.3 --bound inside_max_m=3e-4"},
    {"decide", "converge", "how accurate is a number?", add_converge,
     "converge drag_molar --metric force_max_N\n"
     "converge mine.json --levels 5 --metric inside_max_m\n"
     "converge drag_molar --vary environment.spacing_m"},
    {"decide", "stress", "does any law break on degenerate contacts?", add_stress,
     "stress\n"
     "stress --count 1000\n"
     "stress --module ./my_law.so"},
    {"decide", "reproduce", "which claims of the thesis hold?", add_reproduce,
     "reproduce\n"
     "reproduce --only T2,R1b\n"
     "reproduce --choices results/reference/readings.csv"},
    {"look", "describe", "what is a name? without one: what is there?", add_describe,
     "describe\n"
     "describe shaped_stiffness\n"
     "describe scenarios --grep molar"},
    {"look", "plot", "a picture of results", nullptr},
    {"look", "report", "a page of results with replay; of two: what differs", nullptr}};

}  // namespace

std::span<const CommandGuide> command_guides() {
  return kCommands;
}

}  // namespace hapbench
