#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "scenarios/description/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// Judges whether a run of any scene is stable: by the classes of classify.hpp, and by where its tool ends.
namespace hapbench {

/// The classes of motion, and two ends of a run that no motion tells. run_verdict_meaning() explains each.
enum class RunVerdict { stable, dying_out, vibrating, diverged, thrown_out, no_contact };
inline constexpr std::array kRunVerdicts = {RunVerdict::stable,   RunVerdict::dying_out,  RunVerdict::vibrating,
                                            RunVerdict::diverged, RunVerdict::thrown_out, RunVerdict::no_contact};

/// "stable", "dying_out", ...
std::string_view run_verdict_name(RunVerdict verdict) noexcept;
const char* run_verdict_meaning(RunVerdict verdict) noexcept;

/// True of what comes to rest in contact: stable, dying_out.
inline bool is_stable(RunVerdict verdict) noexcept {
  return verdict == RunVerdict::stable || verdict == RunVerdict::dying_out;
}

/// True when a script moves the hand or turns the tool: then the tool never comes to rest, and only what is above 30 Hz
/// and 1 mm/s counts as motion.
bool is_moved(const Scenario& scenario);

/// What the last quarter of a run is like.
struct SettledState {
  /// Root mean square of the handle's speed above 30 Hz [m/s]; none at sampling rates of 60 Hz or less.
  std::optional<double> vibration;
  double contacts = 0.0;    ///< mean number of rendered contacts of the rows in contact
  double lambda_max = 0.0;  ///< largest eigenvalue of their mean S: the stiffness rendered, in units of K
};

struct JudgedRun {
  RunVerdict verdict = RunVerdict::stable;
  SettledState settled;
  std::uint64_t way = 0;  ///< a hash of all positions of the handle: runs that differ in it moved differently
};

/// Runs the scenario's first trial, without records, and judges it. With `most_vibration` [m/s] that decides between
/// stable and vibrating, by the vibration of the settled state, whatever the class of the motion: a limit cycle that
/// is too small to be felt is stable, and what is felt is not, though it may die out; nothing is stable where no
/// vibration is measured. `shell` is make_shell of the scenario. Throws Stopped when a signal ends it. Precondition:
/// the position is free, and there are 4 steps or more.
JudgedRun judged_run(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell,
                     std::optional<double> most_vibration = {});

/// True when the tool vibrates or diverges without any environment, so that hand and device are to blame and not the
/// contact; `most_vibration` as above. False for hands that do not feel the handle, and for those that need a surface
/// to be there.
bool unstable_without_contact(const LoadedScenario& loaded, std::optional<double> most_vibration = {});

}  // namespace hapbench
