#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "algorithms/registry.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"

/// Claims of appendices B (errors of the original algorithm), C (the proposed algorithm, point density and damping) and
/// F (alternatives).
namespace hapbench {
namespace {

// ---- B1: the force on the tool along the surface normal, <f, n> [N], for a wall point on the far side of the tool's
// axis.

MeasuredValues measure_flipped_gradient(const Evidence&) {
  const auto force_along_normal = [](const char* depth_model) {
    ContactBuffer contacts = wall_point(0.0001, depth_model);
    return make_law("original_averaging", {})->evaluate(contacts).spring.x();
  };
  return {{"with_shortest_distance", {force_along_normal("shortest_distance")}},
          {"with_surface_normal", {force_along_normal("surface_normal")}}};
}

Finding judge_flipped_gradient(const MeasuredCase& m, const PublishedNumbers&) {
  const bool pulled = m["with_shortest_distance"] < 0.0;
  const bool pushed = m["with_surface_normal"] > 0.0;
  return {decide(pulled && pushed, pulled),
          pulled ? "beyond the median line of the drill, the original algorithm pulls the tool in"
                 : "the original algorithm pushes the tool out here"};
}

/// Returns damping_ratio_of_swings() of the tool's x coordinate in a run; NaN if damping_ratio_of_swings() returns
/// nothing.
double damping_ratio_of(const LoadedScenario& loaded) {
  std::vector<double> x;
  for_each_row(checked(loaded), [&](const StepRecord& row) { x.push_back(row.tool.pose.position.x()); });
  return damping_ratio_of_swings(x).value_or(std::nan(""));
}

// ---- B2: a hand presses a mass into a groove of two springs; the mass starts beside the bottom. One case for each
// half angle between the contacts' gradients, with the damping ratios of the oscillation across the groove. If the mass
// does not oscillate, and thus is not under-damped, the damping ratio is NaN.

constexpr double kHalfAngles[] = {10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0};  ///< [degrees]

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
        m.values["given"] = {loaded.scenario.rendering.damping_ratio};
        m.values[scene + "_mu_s"] = {loaded.scenario.rendering.mu_s};
        m.values[scene + "_" + algorithm] = {damping_ratio_of(loaded)};
      }
    }
  }
  return measured;
}

/// Returns the number of angles at which the oscillation with the original algorithm is under-damped in a scene.
double under_damped_angles(const Measured& measured, const PublishedNumbers& p, const char* scene) {
  return static_cast<double>(std::ranges::count_if(measured, [&](const MeasuredCase& m) {
    return m[fmt::format("{}_original_averaging", scene)] <= threshold(p, "under_damped") * m["given"];
  }));
}

/// The earlier rule of B2 judged the damping with friction only.
Verdict judge_groove_with_friction(const Measured& measured, const PublishedNumbers& p) {
  const double with = under_damped_angles(measured, p, "groove_friction");
  return decide(with > threshold(p, "most") * static_cast<double>(measured.size()), with > 0.0);
}

Finding judge_groove(const Measured& measured, const PublishedNumbers& p) {
  const double with = under_damped_angles(measured, p, "groove_friction"),
               without = under_damped_angles(measured, p, "groove_swing"),
               majority = threshold(p, "most") * static_cast<double>(measured.size());
  return {
      decide(with > majority, without > majority),
      fmt::format(
          "the claim is true of the damping of the contacts, which acts only along the merged direction; the friction "
          "of Table B.1 {} the missing damping across this direction",
          with > majority ? "does not hide" : "hides"),
      "",
      fmt::format(
          "without friction, under-damped at {} of {} angles between the contacts; with the scene's viscous friction "
          "of {} N s/m, at {} of {}",
          without, measured.size(), plain(measured.front()["groove_friction_mu_s"]), with, measured.size())};
}

// ---- B3: the merged depth before and after adding two points, in units of the depth of each point. With n = kPoints,
// n + 1 points have the gradient -x, and n points (after adding, n + 2 points) have the gradient +x. The two added
// points reverse the merged direction.

constexpr std::size_t kPoints = 10;
constexpr double kExact = 1e-9;

MeasuredValues measure_added_points(const Evidence&) {
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
  return {{"depth_before", {before.norm()}},
          {"depth_after", {after.norm()}},
          {"direction_product", {before.normalized().dot(after.normalized())}}};
}

Finding judge_added_points(const MeasuredCase& m, const PublishedNumbers&) {
  const auto n = static_cast<double>(kPoints);
  const bool depths =
      std::abs(m["depth_before"] - (2.0 * n + 1.0)) <= kExact && std::abs(m["depth_after"] - (2.0 * n + 3.0)) <= kExact;
  const bool turned = m["direction_product"] <= -1.0 + kExact;
  return {decide(depths && turned, turned),
          depths && turned ? "exactly the values of the formula" : "depth or direction differ from the formula"};
}

/// The laws that P1 compares; the law that the thesis proposes is first.
constexpr const char* kLaws[] = {"shaped_stiffness", "original_averaging", "summation", "mean",
                                 "virtual_coupling", "least_squares"};

constexpr std::size_t kWallDensities[] = {4, 10, 40};  ///< copies of each wall point
/// A contact belongs to the wall if the magnitude of its gradient's z component is below kWall.
constexpr double kWall = 0.5;

/// Returns the contacts with each point of the wall repeated `copies` times.
ContactBuffer with_repeated_wall_points(const ContactBuffer& contacts, std::size_t copies) {
  ContactBuffer more(contacts.size() * copies);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 gradient = contacts.gradient(i);
    for (std::size_t k = 0; k < (std::abs(gradient.z()) < kWall ? copies : 1); ++k) {
      more.push(static_cast<std::uint32_t>(more.size()), contacts.point(i), contacts.normal(i));
      more.set_gradient(more.size() - 1, gradient);
      more.depth[more.size() - 1] = contacts.depth[i];
    }
  }
  more.pad();
  return more;
}

/// Returns the spring force [N] of an algorithm for each contact set, with each point of the wall repeated `copies`
/// times and a tool at rest. Precondition: depths and gradients of the sets have been computed.
std::vector<Vec3> forces_of(const RenderingConfig& config, const Scene& scene, const std::vector<ContactBuffer>& sets,
                            std::size_t copies = 1) {
  const auto algorithm = make_algorithm(config);
  algorithm->prepare(scene);
  ToolState tool;
  tool.pose = kUpright;
  std::vector<Vec3> forces;
  for (const ContactBuffer& set : sets) {
    ContactBuffer contacts = copies == 1 ? set : with_repeated_wall_points(set, copies);
    RenderedForce force;
    algorithm->compute(tool, contacts, force);
    forces.push_back(force.spring);
  }
  return forces;
}

/// Returns the rms of the differences between the second and the first forces, divided by the rms of the first
/// forces.
double change_of_force(const std::vector<Vec3>& first, const std::vector<Vec3>& second) {
  double difference = 0.0, force = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    difference += (second[i] - first[i]).squaredNorm();
    force += first[i].squaredNorm();
  }
  return std::sqrt(difference / force);
}

// ---- P1: change_of_force() for the contacts of task 2 if every point of the wall is repeated, without and with the
// reduction of points. One case for each law. For stiffness shaping, one more case for each number of updates of the
// weights: with many updates, the force should no longer depend on the point density.

constexpr int kUpdates[] = {1, 10, 100, 1000};

Measured measure_density(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance", {"rendering.local_average=false"});
  // Collect contact sets of task 2 before the reduction.
  const std::vector<ContactBuffer> sets = contact_sets(loaded.scenario, 256);
  Scene scene;
  scene.capacity = largest_size(sets) * kWallDensities[std::size(kWallDensities) - 1];
  const auto changes = [&](MeasuredCase& m, const RenderingConfig& config) {
    const std::vector<Vec3> once = forces_of(config, scene, sets);
    for (const std::size_t copies : kWallDensities)
      m.values[fmt::format("x{}{}", copies, config.reduction ? "_reduced" : "")] = {
          change_of_force(once, forces_of(config, scene, sets, copies))};
  };
  Measured measured;
  const auto add = [&](const std::string& name, RenderingConfig config) {
    MeasuredCase& m =
        measured.emplace_back(MeasuredCase{name, {{"updates", {static_cast<double>(config.iterations)}}}});
    m.values["x40_reduced"] = {std::nan("")};  // the value remains NaN for a law without reduction
    changes(m, config);
    config.reduction.reset();
    changes(m, config);
  };
  // One case for each law, then for each number of updates of stiffness shaping.
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
  return {decide(reduced <= small, std::min(all, limit) <= small),
          fmt::format(
              "without the reduction, {} iterations of stiffness shaping {}, {} {} iterations {}. The reduction, which "
              "removes points with similar gradients, {} it",
              measured.front()["updates"],
              all <= small ? "decouple the force from the density" : "do not decouple the force from the density",
              (all <= small) == (limit <= small) ? "and" : "but", kUpdates[std::size(kUpdates) - 1],
              limit <= small ? "decouple it" : "do not", reduced <= small ? "decouples" : "does not decouple")};
}

/// The earlier rule of P1 asked first for the force without the reduction.
Verdict judge_density_before(const Measured& measured, const PublishedNumbers& p) {
  const double all = measured.front()["x40"], reduced = measured.front()["x40_reduced"], limit = measured.back()["x40"],
               small = threshold(p, "negligible");
  return decide(all <= small, std::min(reduced, limit) <= small);
}

// ---- T6: relative change of the spring force in task 2 by the reduction: the rms of the force difference with and
// without the reduction, divided by the rms of the force without the reduction. Stiffness shaping updates its weights
// three times in a step, as in the thesis. The local average is off.

MeasuredValues measure_information(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance", {"rendering.local_average=false"});
  const std::vector<ContactBuffer> sets = contact_sets(loaded.scenario, 64);
  Scene scene;
  scene.capacity = largest_size(sets);
  RenderingConfig config = loaded.scenario.rendering;
  const std::vector<Vec3> reduced = forces_of(config, scene, sets);
  config.reduction.reset();
  return {{"change", {change_of_force(forces_of(config, scene, sets), reduced)}}};
}

Finding judge_information(const MeasuredCase& m, const PublishedNumbers& p) {
  const bool majority = m["change"] <= threshold(p, "over_reduced"), half = m["change"] <= threshold(p, "most");
  return {decide(majority, half),
          "after three iterations, the force from all points differs from the force from the points that the "
          "reduction keeps"};
}

// ---- C6: the damping ratio of 1, 2, 4 and 8 springs in parallel. The stiffness divided by the stiffness of one spring
// is the number of springs.

constexpr double kCounts[] = {1.0, 2.0, 4.0, 8.0};
constexpr double kSpringDamping = 0.1;  ///< damping ratio of one spring; small, so that the mass oscillates many times

Measured measure_relative_damping(const Evidence& e) {
  Measured measured;
  for (const double count : kCounts) {
    const std::vector<std::string> overrides = {
        fmt::format(R"(environment.groups=[{{"direction":[1,0,0],"count":{}}}])", count),
        "initial.position_m=[-0.005,0,0]", fmt::format("rendering.damping_ratio={}", kSpringDamping),
        // With a tenth of the scenario's time step, the numerical damping of the integrator is negligible.
        "time.step_s=0.00005", "time.steps=10000"};
    const double ratio = damping_ratio_of(e.load("springs_unlimited_summation", overrides));
    measured.push_back({fmt::format("{}", count), {{"count", {count}}, {"damping_ratio", {ratio}}}});
  }
  return measured;
}

Finding judge_relative_damping(const Measured& measured, const PublishedNumbers& p) {
  bool same = true;
  double worst = 0.0;
  for (const MeasuredCase& m : measured) {
    const double expected = kSpringDamping * std::sqrt(m["count"]);
    const double off = std::abs(m["damping_ratio"] / expected - 1.0);
    same = same && off <= threshold(p, "same_damping");  // false for NaN
    worst = std::max(worst, off);
  }
  return {decide(same, false),
          fmt::format("the damping ratio is √ρ times that of one spring, with an error of at most {:.2g} %",
                      100.0 * worst)};
}

// ---- F1: the normal projection, compared with stiffness shaping and the depth model surface_normal.
// step, step_shortest: largest change of the force in one time step at a corner [N], with normal projection and with
//   surface_normal.
// pressed: final distance of the tool's tip below a flat surface, with normal projection [m].
// depth, depth_shortest: largest depth of a contact while the tool is pressed into this surface [m], with normal
//   projection and with surface_normal.

MeasuredValues measure_normal_projection(const Evidence& e) {
  const auto z = e.table("flat_press_normal_projection", "trajectory.csv").at("pz_m");
  return {{"step", {e.number("corner_normal_projection", "metrics.force_step_max_N")}},
          {"step_shortest", {e.number("corner_shaped_stiffness", "metrics.force_step_max_N")}},
          {"pressed", {-z.back()}},
          {"depth", {e.number("flat_press_normal_projection", "metrics.depth_max_m")}},
          {"depth_shortest", {e.number("flat_press_shaped_stiffness", "metrics.depth_max_m")}}};
}

Finding judge_normal_projection(const MeasuredCase& m, const PublishedNumbers& p) {
  const bool jumps = m["step"] >= threshold(p, "jumps") * m["step_shortest"];
  const bool faithful = std::abs(m["depth"] / m["pressed"] - 1.0) <= threshold(p, "proportional");
  const bool saturates = m["depth_shortest"] < threshold(p, "saturated") * m["pressed"];
  return {decide(jumps && faithful && saturates, jumps),
          fmt::format("the force {} at the corner; on the flat the normal projection {}, the shortest distance {}",
                      jumps ? "jumps" : "does not jump", faithful ? "does not saturate" : "does not follow",
                      saturates ? "does" : "does not")};
}

// ---- F2, the law tandpasta.
// energy_ratio: elastic energy of the weighted springs, divided by the elastic energy of the unweighted springs.
// boosts: outward force at some prescribed tilts of the planar peg, divided by the outward force of unweighted springs
//   in the same pose.
// tandpasta, summation, shaped_stiffness: time [s] until the peg leaves the hole with this law, without friction and
//   with 1/100 of the scenario's time step. With a smaller time step, the motion would be practically the same.

constexpr double kEnergyKept = 1e-9;                      ///< largest relative change of a conserved energy
constexpr double kBoostTilts[] = {0.08, 0.12, 0.2, 0.4};  ///< [rad]

/// Returns the energy ratio that is furthest from 1 among the contact sets with a force.
double tandpasta_energy_ratio(const Evidence& e) {
  const auto law = make_law("tandpasta", {});
  double ratio = 1.0;
  for (ContactBuffer& set : contact_sets(e.load("task2_rotate_signed_distance").scenario, 64)) {
    law->prepare(set.capacity());
    law->evaluate(set);
    double weighed = 0.0, unweighed = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      weighed += set.weight[i] * set.depth[i] * set.depth[i];
      unweighed += set.depth[i] * set.depth[i];
    }
    if (weighed > 0.0 && std::abs(weighed / unweighed - 1.0) > std::abs(ratio - 1.0)) ratio = weighed / unweighed;
  }
  return ratio;
}

/// Returns, for the first step at or beyond each tilt, the outward force divided by the outward force of unweighted
/// springs.
std::vector<double> outward_boosts(const Evidence& e) {
  const LoadedScenario loaded = e.load("tilt_sweep_tandpasta");
  const double stiffness = loaded.scenario.rendering.stiffness;
  std::vector<double> boosts;
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    if (boosts.size() == std::size(kBoostTilts) || row.rendered->empty()) return;
    const double tilt = math::acos(-row.tool.pose.axis.y());
    if (tilt < kBoostTilts[boosts.size()]) return;
    Vec3 plain = Vec3::Zero();
    for (std::size_t i = 0; i < row.rendered->size(); ++i) plain -= row.rendered->depth[i] * row.rendered->gradient(i);
    boosts.push_back(row.force.spring.y() / (stiffness * plain.y()));
  });
  return boosts;
}

MeasuredValues measure_tandpasta(const Evidence& e) {
  MeasuredValues values = {{"energy_ratio", {tandpasta_energy_ratio(e)}}, {"boosts", outward_boosts(e)}};
  for (const std::string algorithm : {"tandpasta", "summation", kProposedLaw}) {
    const std::vector<std::string> converged = {"time.step_s=5e-6", "time.steps=200000",
                                                "rendering.friction.mu_s_N_s_per_m=0",
                                                "rendering.friction.mu_f_s_per_m=0", "record.ratio_iterations=[]"};
    values[algorithm] = {e.run("peg_in_hole_2d_" + algorithm, converged).duration};
  }
  return values;
}

Finding judge_tandpasta(const MeasuredCase& m, const PublishedNumbers& p) {
  const std::vector<double>& boosts = m.all("boosts");
  const double smallest = boosts.empty() ? 0.0 : *std::min_element(boosts.begin(), boosts.end());
  const bool unchanged = std::abs(m["energy_ratio"] - 1.0) <= kEnergyKept;
  return {decide(unchanged && smallest >= threshold(p, "boosted"), unchanged && smallest > 1.0),
          fmt::format("the weights {} the elastic energy and {} the outward force", unchanged ? "keep" : "change",
                      smallest > 1.0 ? "raise" : "do not raise"),
          fmt::format(
              "energy ratio {:.12g}; outward force at tilts of {} rad: {:.1f} times that of the plain springs; not "
              "part of the rule: with a time step of 5 µs and without friction, the peg leaves the hole after {:.3f} s "
              "with tandpasta, {:.3f} s with summation, {:.3f} s with stiffness shaping",
              m["energy_ratio"], fmt::join(kBoostTilts, ", "), fmt::join(boosts, ", "), m["tandpasta"], m["summation"],
              m["shaped_stiffness"])};
}

// ---- F4: largest depth of the drill in the block in task 2 [m], while a hand of constant force presses it. Compares
// the laws tandpasta and summation: tandpasta keeps the elastic energy of summation. All contact points are rendered,
// without reduction and local average. One case for each force. For a run that diverges, see
// MeasuredCase::set_diverged().

constexpr double kTurningHands[] = {0.5, 1.0, 2.0};  ///< [N]

Measured measure_quick_penetration(const Evidence& e) {
  Measured measured;
  for (const double force : kTurningHands) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{fmt::format("{} N", force), {}});
    for (const std::string law : {"tandpasta", "summation"}) {
      const Result run = e.run("task2_held", {fmt::format("hand.force_N={}", force), "rendering.algorithm=" + law,
                                              "rendering.local_average=false", "rendering.reduction=null"});
      double depth = 0.0;
      for (const char* hands : {"gentle", "firm"}) {
        const auto deepest = number_of(run.metrics, fmt::format("ideal_trajectory.{}.interpenetration_max_m", hands));
        depth = std::max(depth, deepest.value_or(0.0));
      }
      m.values[law] = {depth};
      if (run.end.outcome == Outcome::diverges) m.set_diverged(law, depth);
    }
  }
  return measured;
}

Finding judge_quick_penetration(const Measured& measured, const PublishedNumbers&) {
  const auto judged = std::ranges::count_if(
      measured, [](const MeasuredCase& m) { return !std::isnan(m["tandpasta"]) && !std::isnan(m["summation"]); });
  const auto less =
      std::ranges::count_if(measured, [](const MeasuredCase& m) { return m["tandpasta"] < m["summation"]; });
  if (judged == 0) {
    const auto diverging = [&](const char* law) {
      return std::ranges::count_if(measured, [&](const MeasuredCase& m) { return std::isnan(m[law]); });
    };
    return {
        Verdict::not_judged,
        fmt::format("tandpasta diverges with {0} of {1} hands, and the plain sum, with which it is compared, "
                    "diverges with {2} of {1} hands; so no hand is left for a comparison",
                    diverging("tandpasta"), measured.size(), diverging("summation")),
        "",
        fmt::format("runs diverge with each of the {} simulated hands, so nothing can be compared", measured.size())};
  }
  const std::string compared = fmt::format(
      "with {} of {} simulated hands, neither run diverges; with {} of these, the drill sinks in less deep with "
      "tandpasta",
      judged, measured.size(), less);
  return {decide(less == judged, less > 0), compared + " than with the plain sum", "", compared};
}

/// The earlier rule of F4 judged the depths of diverging runs.
Verdict judge_quick_penetration_before(const Measured& measured, const PublishedNumbers&) {
  const auto less = std::ranges::count_if(measured, [](const MeasuredCase& m) {
    return m.until_divergence("tandpasta") < m.until_divergence("summation");
  });
  return decide(less == static_cast<std::ptrdiff_t>(measured.size()), less > 0);
}

}  // namespace

std::vector<ClaimRule> appendix_b_c_f() {
  return {single_case<measure_flipped_gradient, judge_flipped_gradient>("B1"),
          {"B2", measure_groove, judge_groove, {judge_groove_with_friction}},
          single_case<measure_added_points, judge_added_points>("B3"),
          {"P1", measure_density, judge_density, {judge_density_before}},
          single_case<measure_information, judge_information>("T6"),
          {"F4", measure_quick_penetration, judge_quick_penetration, {judge_quick_penetration_before}},
          {"C6", measure_relative_damping, judge_relative_damping},
          single_case<measure_normal_projection, judge_normal_projection>("F1"),
          single_case<measure_tandpasta, judge_tandpasta>("F2")};
}

}  // namespace hapbench
