#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The groups of benchmarks, and the scenes in which searches and steps are timed. The scenes are built as `hapbench
/// run` builds them. The names of the benchmarks must not change, because scripts and people compare results with equal
/// names between commits.
namespace hapbench::bench {

/// Registers the benchmarks law/<algorithm>/{50,250,1000}, reduction/{50,250,1000} and
/// growth/{law/<algorithm>,reduction}/<contacts>.
void register_laws();
/// Registers the benchmarks step/<one of kSteps>, skip/<name of the skip>/{taken,off} and growth/step/<contacts>. Also
/// registers latency/<name> for some names of kSteps; its counters are times of single steps.
void register_steps();
/// Registers the benchmarks search/{brute_force,neighbour_list}/{T1,T2,T3}, shell/build and
/// growth/{shell,search/<search>,list_rebuild}/<shell points>. With `full`, also registers sizes of shells whose
/// benchmarks take minutes.
void register_searches(bool full);

/// Ends a benchmark because its result is wrong. The program runs the other benchmarks and then exits with status 1.
void refute(benchmark::State& state, const std::string& what);

/// Checks the result of a benchmark with `wrong`. Because this check takes long, `wrong` is called only once per
/// process and benchmark. `wrong` returns a description of the error, or an empty text if the result is right. If there
/// is an error, ends the benchmark like refute() and returns false. Otherwise returns true.
bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong);

/// Numbers of contacts at which the growth of the run time is measured.
inline constexpr std::size_t kGrowthContacts[] = {10, 100, 1000, 10'000, 100'000};

/// Returns n padded contacts of the task T2, with depths and gradients before the reduction. The contacts come from
/// poses 0.1 s apart, which have about 2000 contacts in total. Throws std::logic_error if n is larger than this total.
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

/// Returns the scene of one of kTasks, computed at the first call. The poses of T2 and T3 cover one period of the
/// scripted motion.
const TaskScene& task_scene(std::string_view task);

/// Returns the scenario in which a step is timed. The scenario has all records off. `name` is one of these:
/// - T1, T2 or T3: the task of the thesis; `T2_proxy`: T2 with a proxy
/// - `unreduced_1000`: a drill that nearly fills the hole touches about 1000 points, and nothing is reduced
/// - `free_air`: an upright drill at rest 5 cm above the block
/// - `upright`, `upright_proxy`: a simulated subject of appendix D leads the upright drill over the bottom of the hole,
///   with shaping or with a proxy
/// - `pressed_ideal`, `pressed_impedance`: a hand's spring presses an upright drill on the bottom of the hole, through
///   an ideal device or an impedance device
/// - a task followed by `_mesh`: the scenario of the task; TimedRun replaces its drill by a mesh of the drill
const LoadedScenario& step_scenario(const std::string& name);
/// Returns the bundled scenario with the name `bundled`, with all records off and with overrides as for `--set`.
LoadedScenario load_unrecorded(const char* bundled, std::vector<std::string> overrides);

/// Returns the shell of the block, which all these scenes share; built at the first call.
std::shared_ptr<const PointShell> block_shell();

}  // namespace hapbench::bench
