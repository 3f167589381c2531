#pragma once

#include <memory>
#include <span>
#include <vector>

#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"

/// The scenes in which searches and steps are timed, assembled as the program assembles them.
namespace hapbench::bench {

/// Names of the thesis's tasks: T1 drags the tip over a flat, T2 turns it in the hole, T3 leads it along the wall.
inline constexpr const char* kTasks[] = {"T1", "T2", "T3"};

/// A scenario with its shell and the poses of its tool.
struct TaskScene {
  LoadedScenario loaded;
  std::shared_ptr<const PointShell> shell;
  std::shared_ptr<const ToolShape> tool;
  std::vector<ToolPose> poses;  ///< consecutive, 2048 a second, in contact most of the time
};

/// The scene of one of kTasks, computed once. The poses of T2 and T3 are one period of the script.
const TaskScene& task_scene(const std::string& task);

/// The scenario a step is timed in: one of kTasks, `T2_proxy` (T2 with a proxy), `unreduced_1000` (a drill that nearly
/// fills the hole touches about 1000 points, none of them reduced away), `free_air` (an upright drill at rest 5 cm
/// above the block), `upright` or `upright_proxy` (a simulated subject of appendix D leads the upright drill over the
/// bottom of the hole, with shaping and with a proxy), `pressed_ideal` or `pressed_impedance` (a hand's spring presses
/// an upright drill on the bottom of the hole, through either device), or a task with `_mesh` behind it, whose
/// drill TimedRun replaces by a mesh of it. Nothing is recorded.
const LoadedScenario& step_scenario(const std::string& name);
/// A bundled scenario with overrides as for `--set`, without records.
LoadedScenario load_unrecorded(const char* bundled, std::vector<std::string> overrides);

/// The shell of all these scenes, which have the same block; built once.
std::shared_ptr<const PointShell> block_shell();

}  // namespace hapbench::bench
