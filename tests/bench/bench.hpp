#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The groups of benchmarks, and the scenes in which searches and steps are timed, assembled as in the program. Names
/// of groups are part of the interface, because scripts and people compare them between commits.
namespace hapbench::bench {

/// law/<algorithm>/{50,250,1000}, reduction/{50,250,1000}, growth/{law/<algorithm>,reduction}/<contacts>
void register_laws();
/// step/<one of kSteps>, latency/<step>: counters of single steps, skip/<what>/{taken,off}, growth/step/<contacts>
void register_steps();
/// search/{brute_force,neighbour_list}/{T1,T2,T3}, shell/build, growth/{shell,search/<search>,list_rebuild}/<shell
/// points>; if `full` also for shells that take minutes
void register_searches(bool full);

/// Ends a benchmark whose result is wrong, and ends the program with status 1.
void refute(benchmark::State& state, const std::string& what);

/// For long checks: calls `wrong` once for each process and benchmark. It returns a description of what is wrong with
/// the result, or nothing. Refutes the benchmark if something is wrong. Returns true if the result is right.
bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong);

/// Numbers of contacts over which growth is measured.
inline constexpr std::size_t kGrowthContacts[] = {10, 100, 1000, 10'000, 100'000};

/// Returns n contacts with depths and gradients before the reduction, from poses of T2 a tenth of a second apart, at
/// most about 2000. Padded.
ContactBuffer task_contacts(std::size_t n);

// ---- Scenes

/// Names of the thesis's tasks: T1 drags the tip over a flat face, T2 rotates the tool in the hole, T3 moves it along
/// the wall.
inline constexpr const char* kTasks[] = {"T1", "T2", "T3"};

/// A scenario with its shell and the poses of its tool.
struct TaskScene {
  LoadedScenario loaded;
  std::shared_ptr<const PointShell> shell;
  std::shared_ptr<const ToolShape> tool;
  std::vector<ToolPose> poses;  ///< consecutive poses, 2048 per second, in contact most of the time
};

/// Returns the scene of one of kTasks, which is computed once. The poses of T2 and T3 are one period of the script.
const TaskScene& task_scene(std::string_view task);

/// The scenario a step is timed in: one of kTasks, `T2_proxy` (T2 with a proxy), `unreduced_1000` (a drill that nearly
/// fills the hole touches about 1000 points, none of them reduced away), `free_air` (an upright drill at rest 5 cm
/// above the block), `upright` or `upright_proxy` (a simulated subject of appendix D leads the upright drill over the
/// bottom of the hole, with shaping and with a proxy), `pressed_ideal` or `pressed_impedance` (a hand's spring presses
/// an upright drill on the bottom of the hole, through either device), or a task with `_mesh` behind it, whose
/// drill TimedRun replaces by a mesh of it. Nothing is recorded.
const LoadedScenario& step_scenario(const std::string& name);
/// Returns a bundled scenario with overrides as for `--set`, without records.
LoadedScenario load_unrecorded(const char* bundled, std::vector<std::string> overrides);

/// Returns the shell of all these scenes, which have the same block; built once.
std::shared_ptr<const PointShell> block_shell();

}  // namespace hapbench::bench
