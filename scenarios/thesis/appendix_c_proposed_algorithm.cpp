#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "results/io/columns.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of appendix C: what the proposed algorithm does to point density and damping.
namespace hapbench {
namespace {

/// The laws that P1 compares; the thesis's is first.
constexpr const char* kLaws[] = {"shaped_stiffness", "original_averaging", "summation", "mean",
                                 "virtual_coupling", "least_squares"};

constexpr std::size_t kWallDensities[] = {4, 10, 40};
/// Gradients less steep than this belong to the wall.
constexpr double kWall = 0.5;

/// The contacts with so many points in place of each point of the wall.
ContactBuffer crowded(const ContactBuffer& contacts, std::size_t times) {
  ContactBuffer more(contacts.size() * times);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 gradient = contacts.gradient(i);
    for (std::size_t k = 0; k < (std::abs(gradient.z()) < kWall ? times : 1); ++k) {
      more.push(static_cast<std::uint32_t>(more.size()), contacts.point(i), contacts.normal(i));
      more.set_gradient(more.size() - 1, gradient);
      more.depth[more.size() - 1] = contacts.depth[i];
    }
  }
  more.pad();
  return more;
}

/// The spring forces of an algorithm for sets of contacts with depths and gradients, of which each point of the wall is
/// there so many times, under a tool at rest.
std::vector<Vec3> forces_of(const RenderingConfig& config, const Scene& scene, const std::vector<ContactBuffer>& sets,
                            std::size_t times = 1) {
  const auto algorithm = make_algorithm(config);
  algorithm->prepare(scene);
  ToolState tool;
  tool.pose = kUpright;
  std::vector<Vec3> forces;
  for (const ContactBuffer& set : sets) {
    ContactBuffer contacts = times == 1 ? set : crowded(set, times);
    RenderedForce force;
    algorithm->compute(tool, contacts, force);
    forces.push_back(force.spring);
  }
  return forces;
}

/// How much the second spring forces differ from the first, rms over rms.
double change_of_force(const std::vector<Vec3>& first, const std::vector<Vec3>& second) {
  double difference = 0.0, force = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    difference += (second[i] - first[i]).squaredNorm();
    force += first[i].squaredNorm();
  }
  return std::sqrt(difference / force);
}

// ---- P1: how much the spring force of contacts of task 2 changes, rms over rms, if every point of the wall is there
// many times: with all points, and after the reduction. A case for each law; of ours, another for each number of
// updates, whose limit decouples.

constexpr int kUpdates[] = {1, 10, 100, 1000};

Measured measure_density(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance", {"rendering.local_average=false"});
  const std::vector<ContactBuffer> sets = contact_sets(loaded.scenario, 256);
  Scene scene;
  scene.capacity = largest_size(sets) * kWallDensities[std::size(kWallDensities) - 1];
  const auto changes = [&](MeasuredCase& m, const RenderingConfig& config) {
    const std::vector<Vec3> once = forces_of(config, scene, sets);
    for (const std::size_t times : kWallDensities)
      m.values[fmt::format("x{}{}", times, config.reduction ? "_reduced" : "")] = {
          change_of_force(once, forces_of(config, scene, sets, times))};
  };
  Measured measured;
  const auto add = [&](const std::string& name, RenderingConfig config) {
    MeasuredCase& m =
        measured.emplace_back(MeasuredCase{name, {{"updates", {static_cast<double>(config.iterations)}}}});
    m.values["x40_reduced"] = {std::nan("")};  // of a law that has no reduction
    changes(m, config);
    config.reduction.reset();
    changes(m, config);
  };
  for (const char* law : kLaws) add(law, with_algorithm(loaded.scenario, law).rendering);
  for (const int updates : kUpdates) {
    RenderingConfig config = loaded.scenario.rendering;
    config.iterations = updates;
    add(fmt::format("m = {}", updates), config);
  }
  return measured;
}

Finding judge_density(const Measured& measured, const PublishedNumbers& p) {
  const double all = measured.front()["x40"], reduced = measured.front()["x40_reduced"], limit = measured.back()["x40"],
               small = threshold(p, "negligible");
  return {
      decide(all <= small, std::min(reduced, limit) <= small), "",
      fmt::format("{} updates of stiffness shaping {}; its limit {}; the reduction {}", measured.front()["updates"],
                  all <= small ? "decouple the force from density" : "are too few to decouple the force from density",
                  limit <= small ? "decouples" : "does not", reduced <= small ? "does" : "does not")};
}

// ---- C6: the damping ratio of one, two, … springs in parallel, whose stiffness ratio is their number.

constexpr double kCounts[] = {1.0, 2.0, 4.0, 8.0};
constexpr double kSpringDamping = 0.1;  ///< small enough for many swings

Measured measure_relative_damping(const Evidence& e) {
  Measured measured;
  for (const double count : kCounts) {
    const std::vector<std::string> overrides = {
        fmt::format(R"(environment.groups=[{{"direction":[1,0,0],"count":{}}}])", count),
        "initial.position_m=[-0.005,0,0]", fmt::format("rendering.damping_ratio={}", kSpringDamping),
        // With a tenth of the step the integrator's own damping is negligible.
        "time.step_s=0.00005", "time.steps=10000"};
    std::vector<double> way;
    for_each_row(e.load("springs_unlimited_summation", overrides),
                 [&](const StepRecord& row) { way.push_back(row.tool.pose.position.x()); });
    measured.push_back(
        {fmt::format("{}", count),
         {{"count", {count}}, {"damping_ratio", {damping_ratio_of_swings(way).value_or(std::nan(""))}}}});
  }
  return measured;
}

Finding judge_relative_damping(const Measured& measured, const PublishedNumbers& p) {
  bool same = true;
  double worst = 0.0;
  for (const MeasuredCase& m : measured) {
    const double expected = kSpringDamping * std::sqrt(m["count"]);
    const double off = std::abs(m["damping_ratio"] / expected - 1.0);
    same = same && off <= threshold(p, "same_damping");  // no ratio is another one
    worst = std::max(worst, off);
  }
  return {decide(same, false), "", fmt::format("√ρ times that of one spring to {:.2g} %", 100.0 * worst)};
}

}  // namespace

std::vector<ClaimRule> appendix_c_proposed_algorithm() {
  return {
      {"P1", measure_density, judge_density},
      {"C6", measure_relative_damping, judge_relative_damping},
  };
}

}  // namespace hapbench
