#include "scenarios/program/describe/json_keys.hpp"

#include <string>

namespace hapbench {
namespace {

struct KeyMeaning {
  const char *name, *unit, *meaning;
};

constexpr KeyMeaning kSummaryKeys[] = {
    {"divergence", "",
     "for a run that diverged: step and time at which a quantity left its bound or was no longer a number; otherwise "
     "null"},
    {"warnings", "", "warnings about the run; each names the field concerned"},
    {"rule", "", "member of diagnosis: the rule that applies (hapbench describe diagnosis)"},
    {"says", "", "member of diagnosis: what is wrong with the run"},
    {"try", "", "member of diagnosis: what to change"},
    {"final_position_m", "m",
     "position of the tip's centre at the last step: three numbers; as metrics final_position_m.x, .y and .z"},
    {"half_width_m", "m", "member of tool: half the thickness of the tool"},
    {"reach_m", "m", "member of tool: distance from the tip's centre to the farthest point of the tool"},
    {"convex", "", "member of tool: true if the tool is convex"},
    {"outline_m", "m",
     "member of tool: points of the outline, each with its coordinate along the axis from the tip's centre, and its "
     "distance from the axis"},
    {"gentle", "", "member of ideal_trajectory: metrics over the recorded steps with a hand force below 2 N"},
    {"firm", "", "member of ideal_trajectory: metrics over the recorded steps with a hand force of at least 2 N"},
    {"events", "", "member of energy: the steps in which the springs created the largest energies, largest first"},
    {"appeared", "1",
     "member of an event: number of rendered contacts that exist in its step but not in the previous step"},
    {"vanished", "1",
     "member of an event: number of rendered contacts that exist in the previous step but not in its step"},
    {"state_hash", "",
     "hash of position, velocity and rendered force in all steps; it is equal for two runs in which these numbers are "
     "equal to the last bit"},
    {"work", "", "counters of the computation"},
    {"queries", "1", "member of work: number of contact searches"},
    {"points_tested", "1", "member of work: number of surface points that were compared with the tool"},
    {"lists_rebuilt", "1", "member of work: number of times that the list of surface points near the tool was built"},
    {"steps_skipped", "1", "member of work: number of steps without a contact search, because none was needed"},
    {"steps_controlled", "1", "member of work: number of steps in which a passivity controller changed the force"},
    {"points_dropped", "1", "member of work: number of contacts that exceeded the largest number of contacts"},
    {"allocations", "1", "member of work: number of heap allocations during the steps"},
    {"hapbench_version", "", "member of provenance: version of the program"},
    {"scenario_hash", "", "member of provenance: hash of the scenario and of the files that it names"},
    {"cpu", "", "model of the processor"},
    {"commit", "", "commit of the source from which the program was built; \"-dirty\" if files differ from it"},
    {"compiler", "", "name and version of the compiler"},
    {"build_type", "", "build type of CMake, such as Release"},
    {"flags", "", "compiler flags that can change numbers"}};

constexpr KeyMeaning kTimingKeys[] = {
    {"shell_s", "s", "time to compute or load the points on the environment's surface"},
    {"loop_s", "s", "time of all steps, with observers and recorders"},
    {"step_mean_s", "s", "mean wall time of one step, with observers and recorders"},
    {"step_latency", "", "with record.timing: distribution of the wall times of steps, with observers and recorders"},
    {"clock_overhead_s", "s", "member of step_latency: time to read the clock, subtracted from each step"},
    {"p50_s", "s", "member of step_latency: median of the times of steps"},
    {"p95_s", "s", "member of step_latency: 95th percentile of the times of steps"},
    {"p99_s", "s", "member of step_latency: 99th percentile of the times of steps"},
    {"p99_9_s", "s", "member of step_latency: 99.9th percentile of the times of steps"},
    {"max_s", "s", "member of step_latency: longest time of a step"},
    {"deadline_misses", "", "member of step_latency: for each deadline, the number of steps that took longer"},
    {"histogram", "", "member of step_latency: numbers of steps with times from from_s to to_s"},
    {"from_s", "s", "member of histogram: shortest time of a step that is counted"},
    {"to_s", "s", "member of histogram: the counted steps took less than this time"},
    {"over_time_s", "s",
     "member of step_latency: the run is divided into at most 240 parts of equal length; median time of a step in "
     "each part"},
    {"preemptions", "1", "number of times that the system interrupted the steps for another process"},
    {"build", "", "the build of the program, with the instruction set, which changes times but no results"},
    {"march", "", "member of build: value of the compiler option -march; empty for the compiler's default"},
    {"instruction_set", "", "member of build: widest vector instructions that the program may use"},
    {"simd", "", "member of build: true for the program with vector instructions, false for the scalar program"}};

constexpr KeyMeaning kColumnsKeys[] = {{"meaning", "", "meaning of a column, in one sentence"},
                                       {"unit", "", "unit of a column; \"1\" for pure numbers"}};

}  // namespace

void add_json_keys(Index& index, const Layout& layout) {
  const auto add = [&](const char* file, const auto& keys) {
    const std::string kind = std::string("key of ") + file;
    for (const auto& [name, unit, meaning] : keys) {
      const Json json = {{"kind", kind}, {"name", name}, {"unit", unit}, {"meaning", meaning}};
      index.push_back({kind, name, meaning, [json, layout] { return entry_description(json, layout); }});
    }
  };
  add("summary.json", kSummaryKeys);
  add("timing.json", kTimingKeys);
  add("columns.json", kColumnsKeys);
}

}  // namespace hapbench
