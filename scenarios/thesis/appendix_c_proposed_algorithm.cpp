#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of appendix C: what the proposed algorithm does to point density and damping.
namespace hapbench {
namespace {

/// The laws that the claims compare; ours is last.
constexpr const char* kLaws[] = {"shaped_stiffness", "original_averaging", "summation", "mean",
                                 "virtual_coupling", "least_squares"};

constexpr std::size_t kWallDensities[] = {4, 40};
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

const MeasuredCase& proposed(const Measured& measured) {
  return *std::find_if(measured.begin(), measured.end(), [](const MeasuredCase& m) { return m.name == kProposedLaw; });
}

// ---- P1: how much the spring force of contacts of task 2 changes, rms over rms, if every point of the wall is there
// many times: with all points, and after the reduction. A case for each law.

Measured measure_density(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const std::vector<ContactBuffer> sets = contact_sets(loaded.scenario, 256);
  Scene scene;
  scene.capacity = largest_size(sets) * kWallDensities[std::size(kWallDensities) - 1];
  Measured measured;
  for (const char* law : kLaws) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{law, {}});
    for (const bool reduced : {false, true}) {
      RenderingConfig config = with_algorithm(loaded.scenario, law).rendering;
      if (!reduced) config.reduction.reset();
      const std::vector<Vec3> once = forces_of(config, scene, sets);
      for (const std::size_t times : kWallDensities) {
        const double change = change_of_force(once, forces_of(config, scene, sets, times));
        m.values[reduced ? "reduced" : "all"].push_back(change);
      }
    }
  }
  return measured;
}

Finding judge_density(const Measured& measured, const PublishedNumbers& p) {
  const std::string text = said_of_each(measured, [](const MeasuredCase& m) {
    return fmt::format("{} {:.3g} %, {:.3g} %", m.name, 100.0 * m.all("all").back(), 100.0 * m.all("reduced").back());
  });
  const MeasuredCase& shaped = proposed(measured);
  const double all = shaped.all("all").back(), reduced = shaped.all("reduced").back(),
               small = threshold(p, "negligible");
  return {decide(all <= small, reduced <= small),
          fmt::format("change of the force in task 2 by {} times the points of the wall, with all points and after the "
                      "reduction: {}; with {} times, stiffness shaping: {:.3g} %, {:.3g} %",
                      kWallDensities[1], text, kWallDensities[0], 100.0 * shaped.all("all").front(),
                      100.0 * shaped.all("reduced").front()),
          fmt::format("{} decouples the force from the number of points on the wall",
                      all <= small       ? "stiffness shaping alone"
                      : reduced <= small ? "the reduction, and not stiffness shaping alone,"
                                         : "not even the reduction")};
}

// ---- C5: how much the local average changes the spring force in task 2, rms over rms, with the reduction where the
// law has it. A case for each law.

Measured measure_local_average(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const auto shell = make_shell(loaded.scenario, loaded.files);
  Scene scene;
  scene.capacity = shell->size();
  scene.shell = shell.get();
  const std::vector<ContactBuffer> sets = contact_sets(loaded.scenario, 128);
  Measured measured;
  for (const char* law : kLaws) {
    RenderingConfig config = with_algorithm(loaded.scenario, law).rendering;
    const std::vector<Vec3> without = forces_of(config, scene, sets);
    config.local_average = true;
    const double change = change_of_force(without, forces_of(config, scene, sets));
    measured.push_back({law, {{"change", {change}}}});
  }
  return measured;
}

Finding judge_local_average(const Measured& measured, const PublishedNumbers& p) {
  const std::string text = said_of_each(
      measured, [](const MeasuredCase& m) { return fmt::format("{} {:.1f} %", m.name, 100.0 * m["change"]); }, ", ");
  const double shaped = proposed(measured)["change"];
  const bool least = std::all_of(measured.begin(), measured.end(), [shaped](const MeasuredCase& m) {
    return m["change"] >= shaped || m.name == "least_squares";
  });
  const bool hardly = shaped <= threshold(p, "negligible");
  return {decide(hardly, least), "change of the spring force in task 2 by the local average: " + text,
          fmt::format("with stiffness shaping the local average changes the force {}",
                      hardly  ? "hardly"
                      : least ? "less than with any other law of the thesis, but not negligibly"
                              : "more than with another law of the thesis")};
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
  std::string text;
  for (const MeasuredCase& m : measured) {
    const double expected = kSpringDamping * std::sqrt(m["count"]);
    const double off = std::abs(m["damping_ratio"] / expected - 1.0);
    same = same && off <= threshold(p, "same_damping");  // no ratio is another one
    worst = std::max(worst, off);
    append_item(text, fmt::format("ρ = {}: {:.4f}", m.name, m["damping_ratio"]), ", ");
  }
  return {decide(same, false),
          fmt::format("springs with a damping ratio of {} each, together: {}", kSpringDamping, text),
          fmt::format("√ρ times that of one spring to {:.2g} %", 100.0 * worst)};
}

}  // namespace

std::vector<ClaimRule> appendix_c_proposed_algorithm() {
  return {
      {"P1", measure_density, judge_density},
      {"C5", measure_local_average, judge_local_average},
      {"C6", measure_relative_damping, judge_relative_damping},
  };
}

}  // namespace hapbench
