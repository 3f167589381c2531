#include <algorithm>
#include <cmath>

#include "algorithms/laws/tandpasta.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/rules.hpp"

/// Claims of chapter 4 and appendix F: what the thesis discusses as limits, and its optional algorithms.
namespace hapbench {
namespace {

Finding judge_reduction(const Evidence& e) {
  const char *reduced = "over_reduction_reduced", *unreduced = "over_reduction_unreduced";
  const auto a = e.results.table(reduced, "trajectory.csv"), b = e.results.table(unreduced, "trajectory.csv");
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < b.at("fx_N").size(); ++i) {
    const Vec3 with{a.at("fx_N")[i], a.at("fy_N")[i], a.at("fz_N")[i]};
    const Vec3 without{b.at("fx_N")[i], b.at("fy_N")[i], b.at("fz_N")[i]};
    difference = std::max(difference, (with - without).norm());
    largest = std::max(largest, without.norm());
  }
  return judge_over_reduction(e.results.number(reduced, "metrics.rendered_max"),
                              e.results.number(unreduced, "metrics.rendered_max"), difference / largest);
}

Finding judge_rotation(const Evidence& e) {
  const auto table = e.results.table("pure_rotation", "energy.csv");
  const auto& rotation = table.at("rotation_J");
  return judge_pure_rotation(*std::max_element(rotation.begin(), rotation.end()), table.at("damping_J").back());
}

Finding judge_faces(const Evidence& e) {
  const Scenario scenario = load_scenario(find_scenario("parallel_faces")).scenario;
  const double depth = e.results.number("parallel_faces", "metrics.depth_max_m");
  return judge_parallel_faces(depth, scenario.tool.diameter / 2.0,
                              e.results.number("parallel_faces", "metrics.force_max_N"),
                              scenario.rendering.stiffness * depth);
}

Finding judge_actuators(const Evidence&) {
  return {Verdict::not_reproducible, "",
          "which stiffness saturates the actuators depends on the trainer's mechanics, which are not published"};
}

Finding judge_projection(const Evidence& e) {
  const auto z = e.results.table("flat_press_normal_projection", "trajectory.csv").at("pz_m");
  return judge_normal_projection(e.results.number("corner_normal_projection", "metrics.force_step_max_N"),
                                 e.results.number("corner_shaped_stiffness", "metrics.force_step_max_N"), -z.back(),
                                 e.results.number("flat_press_normal_projection", "metrics.depth_max_m"),
                                 e.results.number("flat_press_shaped_stiffness", "metrics.depth_max_m"));
}

Finding judge_toothpaste(const Evidence& e) {
  PrecisionOptions options;
  options.cache = e.cache;
  const Scenario scenario = drill_in_hole(load_scenario(find_scenario("task2_rotate_signed_distance")).scenario);
  const auto law = make_tandpasta({});
  // The farthest from 1 of all contact sets that give a force at all.
  double ratio = 1.0;
  for (ContactBuffer& set : contact_sets(scenario, options, 64)) {
    law->prepare(set.capacity());
    law->evaluate(set);
    double weighed = 0.0, plain = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      weighed += set.weight[i] * set.depth[i] * set.depth[i];
      plain += set.depth[i] * set.depth[i];
    }
    if (weighed > 0.0 && std::abs(weighed / plain - 1.0) > std::abs(ratio - 1.0)) ratio = weighed / plain;
  }
  return judge_tandpasta(ratio, e.results.number("peg_in_hole_2d_tandpasta", "steps"),
                         e.results.number("peg_in_hole_2d_shaped_stiffness", "steps"));
}

constexpr Claim kClaims[] = {
    {"C1", "4.1", "dense points with gradually changing normals collapse to one", "one point left",
     "reproduced: one of at least ten is left and the force changes by at least 10 %", judge_reduction},
    {"C2", "4.4", "a tool that only turns is not damped", "",
     "reproduced: rotation loads the springs, damping takes nothing out", judge_rotation},
    {"C3", "4.6", "between two parallel faces rotation meets no force", "",
     "reproduced: sinks in by 80 % of the radius, net force below 1 % of one wall's", judge_faces},
    {"C4", "4.3, C.4.2", "stiffness beyond some value saturates the actuators", "about 80 000 or 60 000 N/m",
     "needs the trainer", judge_actuators},
    {"F1", "F.1, Fig. F.4", "the normal projection does not saturate on a flat, and jumps at a corner", "",
     "reproduced: five times the force step, follows the press where the shortest distance saturates",
     judge_projection},
    {"F2", "F.2, Fig. F.5", "tandpasta keeps the elastic energy and throws the tool out", "",
     "reproduced: energy unchanged to 1e-9, the peg leaves five times as fast", judge_toothpaste},
};

}  // namespace

std::span<const Claim> discussion_claims() {
  return kClaims;
}

}  // namespace hapbench
