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

/// Assembles forces and runs from an environment and a tool, in the same way as the scenario runner.
namespace hapbench::test {

/// A tool in an environment, which is either a set of springs or a shell of points.
struct Setting {
  Cylinder tool;
  ToolPose pose;
  std::optional<SpringSet> springs;
  std::vector<SurfacePoint> points;
  double cell_size = 0.0;
};

/// Returns the setting rotated by R about the origin, then translated by t. Springs stay attached to the
/// origin: with springs, t must be zero.
Setting moved(Setting setting, const Mat3& R, const Vec3& t);

/// Returns the setting with every length multiplied by s.
Setting scaled(Setting setting, double s);

/// Returns the setting with its points or springs in a random order.
Setting permuted(Setting setting, Random& random);

/// Computes single forces of an algorithm in a setting.
class Probe {
 public:
  Probe(const Probe&) = delete;
  Probe(const Setting& setting, const RenderingConfig& config);

  RenderedForce force_at(const ToolPose& pose, const Vec3& velocity = Vec3::Zero(),
                         const Vec3& angular_velocity = Vec3::Zero());
  /// Returns the contacts of the last computed force, with the weights of the algorithm.
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

/// Returns the parts of a run that starts at rest in the setting's pose. No hand holds the tool; its
/// orientation is constant and its position is free.
SimulationParts free_run(const Setting& setting, const RenderingConfig& config);

/// Returns the configuration of a free_run().
SimulationConfig free_run_config(const Setting& setting, const RenderingConfig& config, std::uint64_t steps);

/// Returns a motion with a constant tool axis and a free position.
std::unique_ptr<Motion> constant_axis(const Vec3& axis);

// Small scenes whose rendered force is known analytically.

/// Known properties of the force in a scene, which every algorithm must satisfy.
struct Answer {
  /// Unit vector of the force; zero if the force is zero. Not checked if `only_in_plane`.
  Vec3 direction = Vec3::Zero();
  /// True if some laws may render no force (opposite springs under original_averaging).
  bool may_vanish = false;
  /// True for a planar scene in which it is only known that the force lies in the plane z = 0.
  bool only_in_plane = false;
  /// Exact values of the spring force along `direction` divided by K [m], by name of the law. For other laws, the force
  /// is only bounded.
  std::map<std::string_view, double> spring_over_K = {};
};

struct AnalyticScene {
  std::string_view name;
  /// Depth model for scenes with points. Not used by algorithms that have their own depth model.
  std::string_view depth_model;
  Setting (*setting)();
  Answer (*answer)();
  /// Position of the tool at which the force is zero.
  Vec3 position_without_force;
  /// True if a point lies exactly on the tool's surface. When the scene is moved, rounding then decides whether
  /// the point is in contact.
  bool touches = false;
};

std::span<const AnalyticScene> analytic_scenes();

/// Returns the configuration of `algorithm` for a scene: the thesis's K = 20000 N/m, m = 3 shaping iterations
/// (the default), no friction.
RenderingConfig config_for(std::string_view algorithm, const AnalyticScene& scene);

/// Returns the sum of |d_i| over the scene's contacts, where d_i are the depths under the algorithm's depth
/// model [m]. If all gradients are equal, no law renders more than K times this sum. Rounding errors of the force
/// are in proportion to K times this sum.
double total_depth(const Setting& setting, const RenderingConfig& config);

}  // namespace hapbench::test
