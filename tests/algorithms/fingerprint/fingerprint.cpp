// Prints a hash of every bit that the engine and the algorithms compute, one line per case. The program is built once
// with each variant of the libraries; the outputs of all builds must be the same text.
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <string>

#include "device_model/hands/scripted_hands.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/setting.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::test {
namespace {

void print(const std::string& name, std::uint64_t hash) {
  std::cout << name << ' ' << std::hex << std::setw(16) << std::setfill('0') << hash << std::dec << '\n';
}

RenderingConfig config_of(std::string_view algorithm) {
  RenderingConfig config;
  config.algorithm = algorithm;
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  return config;
}

/// Prints one hash for each gradient distribution: the forces and contacts of the algorithm on random springs at random
/// positions of the tool.
void print_springs(const AlgorithmEntry& algorithm) {
  for (const GradientDistribution& family : gradient_distributions()) {
    Random random(1);
    Hash hash;
    for (int i = 0; i < 20; ++i) {
      Setting setting;
      setting.springs = SpringSet{family.draw(random, random_size(random, 200)), i % 2 == 0};
      setting.pose.position = 0.001 * random.direction();
      Probe probe(setting, config_of(algorithm.info->name));
      hash.add(probe.force_at(setting.pose, random.direction()));
      hash.add(probe.contacts());
    }
    print(std::string(algorithm.info->name) + " springs " + family.name, hash.value());
  }
}

/// Returns the parts of a run of the 2-D peg, with a round tip and a changing tilt.
SimulationParts peg(const RenderingConfig& config) {
  Setting setting;
  setting.tool = {0.0005, 0.005, Tip::round};
  setting.points = surface_points(Hole2d{});
  setting.cell_size = 0.0003;
  SimulationParts parts = free_run(setting, config);
  parts.motion = std::make_unique<ScriptedMotion>(
      Orientation{{0, 1, 0}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), {}}, std::nullopt);
  return parts;
}

/// Returns the parts of a run in which a hand presses the flat tool into a plane while the tool tilts and rotates.
SimulationParts plane(const RenderingConfig& config) {
  Setting setting;
  setting.points = surface_points(Plane{0.006, 0.00011});
  setting.cell_size = 0.00022;
  SimulationParts parts = free_run(setting, config);
  parts.motion = std::make_unique<ScriptedMotion>(Orientation{{0, 0, 1},
                                                              {1, 0, 0},
                                                              Profile::Shape(Profile::Sine{0.3, 0.3, 0.4, 0.0}),
                                                              Profile::Shape(Profile::Ramp{0.0, 3.0})},
                                                  std::nullopt);
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{
      Profile::Shape(Profile::Sine{0.0, 1.0, 0.21, 0.0}), Profile::Shape(Profile::Sine{0.0, 1.0, 0.17, 1.0}), -2.0});
  return parts;
}

void print_runs(const AlgorithmEntry& algorithm, const std::string& depth_model) {
  for (const bool average : {false, true}) {
    for (const bool reduce : {false, true}) {
      RenderingConfig config = config_of(algorithm.info->name);
      config.depth_model = depth_model;
      config.local_average = average;
      if (reduce) config.reduction = ReductionConfig{0.99, 20, 3};
      config.passivity_controller = average && reduce;  // a single configuration with a passivity controller is enough
      const std::string name = std::string(algorithm.info->name) + ' ' + depth_model + (average ? " averaged" : "") +
                               (reduce ? " reduced" : "");
      HashingObserver hash;
      SimulationConfig simulation;
      simulation.steps = 1000;
      simulation.position = {0.0, -0.004, 0.0};
      Simulation(simulation, peg(config), {&hash}).run();
      print(name + " peg", hash.value());

      hash.clear();
      simulation.steps = 400;
      simulation.position = {0.0, 0.0, 0.0001};
      Simulation(simulation, plane(config), {&hash}).run();
      print(name + " plane", hash.value());
    }
  }
}

/// Prints hashes for the 2-D peg under every integrator.
void print_integrators(const AlgorithmEntry& algorithm) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    HashingObserver hash;
    SimulationConfig simulation;
    simulation.steps = 500;
    simulation.position = {0.0, -0.004, 0.0};
    simulation.integrator = integrator;
    Simulation(simulation, peg(config_of(algorithm.info->name)), {&hash}).run();
    print(std::string(algorithm.info->name) + ' ' + integrator->info.name, hash.value());
  }
}

/// Prints a hash of all results of a mesh tool in the shape of a cup, with points in and around the cup.
void print_mesh_tool() {
  const MeshTool tool(grid_of(cup(20), 0.1));
  Random random(4);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 2000; ++i) points.push_back({random.uniform(0.0, 2.0) * random.direction(), random.direction()});
  const PointShell shell(points, 0.1);
  const auto search = make_contact_query(shell, tool, Skips::on);
  ContactBuffer contacts(search->capacity());
  std::vector<double> exits(search->capacity());
  AlignedDoubles x(simd::padded(search->capacity())), y(x.size()), z(x.size());
  Hash hash;
  for (int i = 0; i < 200; ++i) {
    const ToolPose pose{0.3 * random.direction(), random.direction(), random.uniform(-3.0, 3.0)};
    search->contacts_at(pose, contacts);
    tool.shortest_depths(pose, contacts);
    tool.shortest_gradients(pose, contacts);
    hash.add(contacts);
    tool.exit_distances(pose, contacts, exits.data());
    for (std::size_t k = 0; k < contacts.size(); ++k) hash.add(exits[k]);
    tool.surface_constraints(pose, random.direction(), 0.0, contacts);
    hash.add(contacts);
    tool.support_points(pose, contacts, {x.data(), y.data(), z.data()});
    for (std::size_t k = 0; k < contacts.size(); ++k) hash.add(Vec3(x[k], y[k], z[k]));
  }
  print("mesh tool", hash.value());
}

/// Prints hashes of the results of a kind of tool: search, depths, constraints and support points. The points lie
/// inside, on and around the tool.
void print_tools(const ToolKind& kind) {
  Random random(4);
  Hash hash;
  for (int i = 0; i < 200; ++i) {
    const DefinedTool tool = kind.make(random, 0.001);
    const ToolPose pose = random_pose(random);
    std::vector<SurfacePoint> points(64);
    for (SurfacePoint& p : points) {
      p = {random.below(2) == 0 ? tool.near_point(pose, random) : tool.surface_point(pose, random), random.direction()};
    }
    const PointShell shell(points, 0.0);
    const auto query = make_contact_query(shell, *tool.shape, Skips::on);
    ContactBuffer contacts(points.size());
    const auto brute_force = make_contact_query(shell, *tool.shape, Skips::off);  // brute force has its own loop
    brute_force->contacts_at(pose, contacts);
    hash.add(contacts);
    query->contacts_at(pose, contacts);
    tool.shape->shortest_depths(pose, contacts);
    tool.shape->shortest_gradients(pose, contacts);
    hash.add(contacts);
    std::vector<double> exits(contacts.size());
    tool.shape->exit_distances(pose, contacts, exits.data());
    for (const double exit : exits) hash.add(exit);

    ContactBuffer all(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k) all.push(k, points[k].position, points[k].normal);
    tool.shape->surface_constraints(pose, 1e-3 * random.direction(), 1e-5, all);
    hash.add(all);
    AlignedDoubles x(points.size()), y(x), z(x);
    tool.shape->support_points(pose, all, {x.data(), y.data(), z.data()});
    for (std::size_t k = 0; k < points.size(); ++k) hash.add(Vec3(x[k], y[k], z[k]));
  }
  print(std::string("tool ") + kind.name, hash.value());
}

}  // namespace
}  // namespace hapbench::test

int main() {
  using namespace hapbench;
  using namespace hapbench::test;
  print_mesh_tool();
  for (const ToolKind& kind : tool_kinds()) print_tools(kind);
  for (const AlgorithmEntry& algorithm : algorithms()) {
    print_springs(algorithm);
    print_integrators(algorithm);
    for (const DepthModelEntry& model : depth_models()) {
      if (algorithm.fixed_depth_model.empty() || algorithm.fixed_depth_model == model.info->name) {
        print_runs(algorithm, model.info->name);
      }
    }
  }
}
