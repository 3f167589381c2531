#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/measurements.hpp"

/// Claims of appendix C: what the proposed algorithm does to point density and damping.
namespace hapbench {
namespace {

/// The laws that the claims compare; ours is last.
constexpr const char* kLaws[] = {"shaped_stiffness", "original_averaging", "summation", "mean",
                                 "virtual_coupling", "least_squares"};

/// The force of an algorithm for contacts with depths and gradients, under a tool at rest.
RenderedForce answer(ForceAlgorithm& algorithm, ContactBuffer contacts) {
  ToolState tool;
  tool.pose = kUpright;
  RenderedForce force;
  algorithm.compute(tool, contacts, force);
  return force;
}

const MeasuredCase& proposed(const Measured& measured) {
  return *std::find_if(measured.begin(), measured.end(), [](const MeasuredCase& m) { return m.name == kProposedLaw; });
}

// ---- P1: the stiffness across a corner, in units of K, while the wall beside it has more and more points. A case for
// each law.

constexpr std::size_t kWallDensities[] = {1, 2, 4, 10, 40};
constexpr double kDecoupled = 0.05;

/// Contacts of the wall, one of the corner's edge and one of the top face.
ContactBuffer corner(std::size_t wall_points) {
  ContactBuffer contacts(wall_points + 2);
  const auto add = [&contacts](const Vec3& gradient) {
    contacts.push(static_cast<std::uint32_t>(contacts.size()), Vec3::Zero(), -gradient);
    contacts.set_gradient(contacts.size() - 1, gradient);
    contacts.depth[contacts.size() - 1] = 1e-4;
  };
  for (std::size_t i = 0; i < wall_points; ++i) add(Vec3::UnitX());
  add(Vec3(1.0, 1.0, 0.0).normalized());
  add(Vec3::UnitY());
  contacts.pad();
  return contacts;
}

/// The stiffness tensor of a law without stages.
Mat3 stiffness_of(const char* law, ContactBuffer contacts) {
  RenderingConfig config;
  config.algorithm = law;
  const auto algorithm = make_algorithm(config);
  Scene scene;
  scene.capacity = contacts.capacity();
  algorithm->prepare(scene);
  return answer(*algorithm, std::move(contacts)).S;
}

Measured measure_density(const Evidence&) {
  Measured measured;
  for (const char* law : kLaws) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{law, {}});
    for (const std::size_t density : kWallDensities)
      m.values["stiffness"].push_back(stiffness_of(law, corner(density))(1, 1));
  }
  return measured;
}

Finding judge_density(const Measured& measured, const PublishedNumbers&) {
  const auto change = [](const MeasuredCase& m) {
    const auto [least, most] = std::minmax_element(m.all("stiffness").begin(), m.all("stiffness").end());
    return *most / *least - 1.0;
  };
  std::string text;
  for (const MeasuredCase& m : measured) {
    append_item(text, fmt::format("{} {:.3f} to {:.3f}", m.name, m.all("stiffness").front(), m.all("stiffness").back()),
                ", ");
  }
  const double shaped = change(proposed(measured));
  return {decide(shaped <= kDecoupled, false),
          fmt::format("stiffness across a corner, in units of K, for {} to {} points on the wall beside it: {}",
                      kWallDensities[0], kWallDensities[std::size(kWallDensities) - 1], text),
          fmt::format("with stiffness shaping it changes by {:.2g} %", 100.0 * shaped)};
}

// ---- C5: how much the local average changes the spring force in task 2, rms over rms, with the reduction where the
// law has it. A case for each law.

constexpr double kUnnecessary = 0.05;

Measured measure_local_average(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const auto shell = e.shell(loaded);
  Scene scene;
  scene.capacity = shell->size();
  scene.shell = shell.get();
  const std::vector<ContactBuffer> sets = contact_sets(drill_in_hole(loaded.scenario), 128);
  Measured measured;
  for (const char* law : kLaws) {
    RenderingConfig config = with_algorithm(loaded.scenario, law).rendering;
    const auto without = make_algorithm(config);
    config.local_average = true;
    const auto with = make_algorithm(config);
    without->prepare(scene);
    with->prepare(scene);
    double difference = 0.0, force = 0.0;
    for (const ContactBuffer& contacts : sets) {
      const Vec3 plain = answer(*without, contacts).spring;
      difference += (answer(*with, contacts).spring - plain).squaredNorm();
      force += plain.squaredNorm();
    }
    measured.push_back({law, {{"change", {std::sqrt(difference / force)}}}});
  }
  return measured;
}

Finding judge_local_average(const Measured& measured, const PublishedNumbers&) {
  std::string text;
  for (const MeasuredCase& m : measured)
    append_item(text, fmt::format("{} {:.1f} %", m.name, 100.0 * m["change"]), ", ");
  const double shaped = proposed(measured)["change"];
  const bool least = std::all_of(measured.begin(), measured.end(), [shaped](const MeasuredCase& m) {
    return m["change"] >= shaped || m.name == "least_squares";
  });
  return {decide(shaped <= kUnnecessary, least), "change of the spring force in task 2 by the local average: " + text,
          fmt::format("with stiffness shaping the local average changes the force {}",
                      shaped <= kUnnecessary ? "hardly"
                      : least                ? "less than with any other law of the thesis, but not negligibly"
                                             : "more than with another law of the thesis")};
}

// ---- C6: the damping ratio of one, two, … springs in parallel, whose stiffness ratio is their number.

constexpr double kCounts[] = {1.0, 2.0, 4.0, 8.0};
constexpr double kSpringDamping = 0.1;  ///< small enough for many swings
constexpr double kSameRatio = 0.05;

Measured measure_relative_damping(const Evidence& e) {
  Measured measured;
  for (const double count : kCounts) {
    const std::string overrides[] = {fmt::format(R"(environment.groups=[{{"direction":[1,0,0],"count":{}}}])", count),
                                     "initial.position_m=[-0.005,0,0]",
                                     fmt::format("rendering.damping_ratio={}", kSpringDamping),
                                     // With a tenth of the step the integrator's own damping is negligible.
                                     "time.step_s=0.00005", "time.steps=10000"};
    SwingDecay swings;
    e.for_each_row(e.load("springs_unlimited_summation", overrides),
                   [&](const StepRecord& row) { swings.add(row.tool.pose.position.x()); });
    measured.push_back({fmt::format("{}", count), {{"count", {count}}, {"damping_ratio", {swings.damping_ratio()}}}});
  }
  return measured;
}

Finding judge_relative_damping(const Measured& measured, const PublishedNumbers&) {
  double worst = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    const double expected = kSpringDamping * std::sqrt(m["count"]);
    worst = std::max(worst, std::abs(m["damping_ratio"] / expected - 1.0));
    append_item(text, fmt::format("ρ = {}: {:.4f}", m.name, m["damping_ratio"]), ", ");
  }
  return {decide(worst <= kSameRatio, false),
          fmt::format("springs with a damping ratio of {} each, together: {}", kSpringDamping, text),
          fmt::format("√ρ times that of one spring to {:.2g} %", 100.0 * worst)};
}

}  // namespace

std::vector<Claim> appendix_c_proposed_algorithm() {
  return {
      {.id = "P1",
       .place = "abstract, 1.2, C.2, C.4, 5",
       .claim = "stiffness shaping decouples the force from the density of points",
       .published = "",
       .rule = fmt::format(
           "reproduced: the stiffness across a corner changes by at most {} when the wall beside it has {} times the "
           "points",
           percent(kDecoupled), kWallDensities[std::size(kWallDensities) - 1]),
       .measure = measure_density,
       .judge = judge_density},
      {.id = "C5",
       .place = "C.2",
       .claim = "once stiffness is shaped, the local average is unnecessary",
       .published = "",
       .rule = fmt::format(
           "reproduced: it changes the spring force of stiffness shaping in task 2 by at most {}, rms; in kind: by less "
           "than that of any other law of the thesis",
           percent(kUnnecessary)),
       .measure = measure_local_average,
       .judge = judge_local_average},
      {.id = "C6",
       .place = "C.4.3",
       .claim = "the relative damping of combined contacts grows with the root of the stiffness ratio",
       .published = "√ρ",
       .rule = fmt::format("reproduced: √ρ times the damping ratio of one spring, within {}", percent(kSameRatio)),
       .measure = measure_relative_damping,
       .judge = judge_relative_damping},
  };
}

}  // namespace hapbench
