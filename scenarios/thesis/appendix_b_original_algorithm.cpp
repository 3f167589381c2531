#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "algorithms/registry.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"

/// Claims of appendix B: what is wrong with the original algorithm, on contacts made for it.
namespace hapbench {
namespace {

// ---- B1: <f, n>, the force on the tool along the surface normal of a point beyond the tool's median line.

Measured measure_flipped_gradient(const Evidence&) {
  const auto force_along_normal = [](const char* depth_model) {
    ContactBuffer contacts = wall_point(0.0001, depth_model);
    return make_law("original_averaging", {})->evaluate(contacts).spring.x();
  };
  return {{"",
           {{"with_shortest_distance", {force_along_normal("shortest_distance")}},
            {"with_surface_normal", {force_along_normal("surface_normal")}}}}};
}

Finding judge_flipped_gradient(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool pulled = m["with_shortest_distance"] < 0.0;
  const bool pushed = m["with_surface_normal"] > 0.0;
  return {decide(pulled && pushed, pulled), "",
          pulled ? "beyond the median line the original algorithm pulls the tool in"
                 : "the original algorithm pushes the tool out here"};
}

// ---- B2: a mass that a hand presses into a groove of two springs and that starts beside its bottom. A case for each
// half angle between the contacts' gradients, with the damping ratios of the swings across the groove; no number where
// the mass does not swing, and what does not swing is not under-damped.

constexpr double kHalfAngles[] = {10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0};

Measured measure_groove(const Evidence& e) {
  Measured measured;
  for (const double degrees : kHalfAngles) {
    const double angle = degrees * std::numbers::pi / 180.0, s = math::sin(angle), c = math::cos(angle);
    MeasuredCase& m = measured.emplace_back(MeasuredCase{fmt::format("{}°", degrees), {}});
    for (const std::string scene : {"groove_friction", "groove_swing"}) {
      for (const std::string algorithm : {"original_averaging", "shaped_stiffness"}) {
        const LoadedScenario loaded = e.load(scene, {fmt::format("environment.groups.0.direction=[{},{},0]", -s, -c),
                                                     fmt::format("environment.groups.1.direction=[{},{},0]", s, -c),
                                                     "rendering.algorithm=" + algorithm});
        std::vector<double> across;
        for_each_row(loaded, [&](const StepRecord& row) { across.push_back(row.tool.pose.position.x()); });
        m.values["given"] = {loaded.scenario.rendering.damping_ratio};
        m.values[scene + "_" + algorithm] = {damping_ratio_of_swings(across).value_or(std::nan(""))};
      }
    }
  }
  return measured;
}

Finding judge_groove(const Measured& measured, const PublishedNumbers& p) {
  const auto under_damped = std::count_if(measured.begin(), measured.end(), [&](const MeasuredCase& m) {
    return m["groove_friction_original_averaging"] <= threshold(p, "under_damped") * m["given"];
  });
  return {
      decide(static_cast<double>(under_damped) > threshold(p, "most") * static_cast<double>(measured.size()),
             under_damped > 0),
      "",
      fmt::format("the original algorithm damps along the merged direction only; across it friction does, and it is "
                  "under-damped at {} of {} angles",
                  under_damped, measured.size())};
}

// ---- B3: the merged depth before and after two more points, in units of the common depth.

constexpr std::size_t kPoints = 10;
constexpr double kExact = 1e-9;

Measured measure_added_points(const Evidence&) {
  const auto merged = [](std::size_t one_way) {
    ContactBuffer contacts(2 * kPoints + 3);
    for (std::size_t i = 0; i < kPoints + 1 + one_way; ++i) {
      contacts.push(static_cast<std::uint32_t>(i), Vec3::Zero(), Vec3::UnitX());
      contacts.set_gradient(i, i <= kPoints ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitX()));
      contacts.depth[i] = 1.0;
    }
    contacts.pad();
    RenderingConfig config;
    config.stiffness = 1.0;
    return make_law("original_averaging", config)->evaluate(contacts).spring;
  };
  const Vec3 before = merged(kPoints), after = merged(kPoints + 2);
  return {{"",
           {{"depth_before", {before.norm()}},
            {"depth_after", {after.norm()}},
            {"direction_product", {before.normalized().dot(after.normalized())}}}}};
}

Finding judge_added_points(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const auto n = static_cast<double>(kPoints);
  const bool depths =
      std::abs(m["depth_before"] - (2.0 * n + 1.0)) <= kExact && std::abs(m["depth_after"] - (2.0 * n + 3.0)) <= kExact;
  const bool turned = m["direction_product"] <= -1.0 + kExact;
  return {decide(depths && turned, turned), "",
          depths && turned ? "exact, as the formula says" : "another depth or direction than the formula's"};
}

}  // namespace

std::vector<ClaimRule> appendix_b_original_algorithm() {
  return {
      {"B1", measure_flipped_gradient, judge_flipped_gradient},
      {"B2", measure_groove, judge_groove},
      {"B3", measure_added_points, judge_added_points},
  };
}

}  // namespace hapbench
