#pragma once

#include <memory>
#include <string_view>

#include "scenarios/description/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// Judges whether a run of any scene is stable: by the classes of classify.hpp, and by where its tool ends.
namespace hapbench {

enum class RunVerdict {
  stable,      ///< comes to rest
  dying_out,   ///< comes to rest if the run goes on
  vibrating,   ///< does not decay
  diverged,    ///< left its bounds, or oscillates with a growing amplitude
  thrown_out,  ///< left the hole, or ends without contact beyond the shell's box by more than the tool reaches
  no_contact   ///< touched nothing in any row
};

/// "stable", "dying_out", …
std::string_view run_verdict_name(RunVerdict verdict) noexcept;

/// True of what comes to rest in contact: stable, dying_out.
inline bool is_stable(RunVerdict verdict) noexcept {
  return verdict == RunVerdict::stable || verdict == RunVerdict::dying_out;
}

/// True when a script moves the hand or turns the tool: then the tool never comes to rest, and only what is above 30 Hz
/// and 1 mm/s counts as motion.
bool is_moved(const Scenario& scenario);

/// Runs the scenario's first trial, without records, and judges it. `shell` is make_shell of the scenario. Throws
/// Stopped when a signal ends it. Precondition: the position is free, and there are 4 steps or more.
RunVerdict judged_run(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell);

/// True when the tool vibrates or diverges without any environment, so that hand and device are to blame and not the
/// contact. False for hands that do not feel the handle, and for those that need a surface to be there.
bool unstable_without_contact(const LoadedScenario& loaded);

}  // namespace hapbench
