#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "algorithms/registry.hpp"
#include "sim/contact/contact_source.hpp"
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

}  // namespace hapbench::test
