#pragma once

#include <memory>
#include <optional>

#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/worst_motion/trajectory.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// A scene as the search for the worst motion needs it: a tool at a surface, and a hand that stays there.
struct SearchScene {
  Scenario scenario;  ///< where the tool touches the surface from the start, or is where the scenario has it in a hole
  std::shared_ptr<const PointShell> shell;
  bool planar = false;  ///< all lies in z = 0
  /// Where the hand may aim [m]: the box around the shell, one tool diameter wider. None in a hole, whose walls hold
  /// the tool.
  std::optional<Box> reach;
};

/// Throws InputError unless the scene has a shell, a free position and a time step that is not too fine.
void check_search_scene(const Scenario& scenario);

/// The scene of a search. A tool that starts apart from a surface that is no hole is set against it, on the straight
/// way to the shell's nearest point. Throws as check_search_scene does, and for an empty shell.
SearchScene search_scene(const Scenario& scenario);

/// The scene with its orientation and hand replaced by the trajectory, on an ideal device, with energy recorded. In a
/// hole the hand pushes with the trajectory's force. Elsewhere it does so where the tool starts and less further on, by
/// a spring of 300 N/m whose end stays within reach, so that the tool does not get lost.
Scenario with_trajectory(const SearchScene& scene, const Trajectory& trajectory);

}  // namespace hapbench
