#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "algorithms/registry.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"

/// From an environment and a tool to forces and runs, the way the scenario runner assembles them.
namespace hapbench::test {

/// A tool in an environment: springs, or else a shell of points.
struct Setting {
  Cylinder tool;
  ToolPose pose;
  std::optional<SpringSet> springs;
  std::vector<SurfacePoint> points;
  double cell_size = 0.0;
};

/// The setting turned by R about the origin, then moved by t. Springs stay attached to the origin, so t must be zero.
Setting moved(Setting setting, const Mat3& R, const Vec3& t);

/// Every length of the setting times s.
Setting scaled(Setting setting, double s);

/// The same points or springs in a random order.
Setting permuted(Setting setting, Random& random);

/// One algorithm in one setting, asked for single forces.
class Probe {
 public:
  Probe(const Probe&) = delete;
  Probe(const Setting& setting, const RenderingConfig& config);

  RenderedForce force_at(const ToolPose& pose, const Vec3& velocity = Vec3::Zero(),
                         const Vec3& angular_velocity = Vec3::Zero());
  /// The contacts of the last force, as the algorithm left them.
  const ContactBuffer& contacts() const { return contacts_; }
  ForceAlgorithm& algorithm() { return *algorithm_; }

 private:
  Cylinder tool_;
  std::shared_ptr<const PointShell> shell_;
  std::shared_ptr<const SpringSet> springs_;
  std::unique_ptr<ContactSource> source_;
  std::unique_ptr<ForceAlgorithm> algorithm_;
  ContactBuffer contacts_;
};

/// A run that starts at rest in the setting's pose: nobody holds the tool, its orientation stays, its position is free.
SimulationParts free_run(const Setting& setting, const RenderingConfig& config);

/// Configuration of such a run.
SimulationConfig free_run_config(const Setting& setting, const RenderingConfig& config, std::uint64_t steps);

/// A motion that keeps the axis and leaves the position free.
std::unique_ptr<Motion> constant_axis(const Vec3& axis);

// Small scenes whose rendered force is known without running an algorithm.

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
