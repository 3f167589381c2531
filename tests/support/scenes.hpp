#pragma once

#include <map>
#include <span>
#include <string_view>

#include "tests/support/setting.hpp"

/// Small scenes whose rendered force is known without running an algorithm.
namespace hapbench::test {

/// The force that every algorithm must render in a scene, whatever its law.
struct Answer {
  /// The force is along this unit vector, or zero when it is zero; no claim when `only_in_plane`.
  Vec3 direction = Vec3::Zero();
  /// Some laws may cancel the force to zero (opposite springs under original_averaging).
  bool may_vanish = false;
  /// The scene is planar: all that is known is that nothing leaves the plane z = 0.
  bool only_in_plane = false;
  /// Exact spring force over K in metres along `direction`, for the laws named; other laws are only bounded.
  std::map<std::string_view, double> spring_over_K = {};
};

struct AnalyticScene {
  std::string_view name;
  /// For scenes of points; the algorithm's own depth model takes its place where it has one.
  std::string_view depth_model;
  Setting (*setting)();
  Answer (*answer)();
  /// Position of the tool at which all force vanishes.
  Vec3 position_without_force;
  /// A point lies on the tool's surface to the last bit: once the scene is moved, rounding decides whether it collides.
  bool touches = false;
};

std::span<const AnalyticScene> analytic_scenes();

/// The configuration of `algorithm` in a scene: the thesis's K = 20000 N/m, shaping with the default m = 3, no
/// friction.
RenderingConfig config_for(std::string_view algorithm, const AnalyticScene& scene);

/// Sum of |d_i| over the scene's contacts under the algorithm's depth model [m]: no law renders more than K times this
/// where gradients agree, and it is what rounding errors are measured by.
double total_depth(const Setting& setting, const RenderingConfig& config);

}  // namespace hapbench::test
