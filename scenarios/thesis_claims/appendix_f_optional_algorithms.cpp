#include <fmt/format.h>

#include <cmath>

#include "algorithms/laws/laws.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of appendix F: the thesis's optional algorithms.
namespace hapbench {
namespace {

// ---- F1: the largest force step at a corner [N], and the depth rendered for a press into a flat [m].

constexpr double kForceSteps = 5.0;
constexpr double kFollows = 0.02;
constexpr double kSaturates = 0.8;

Measured measure_normal_projection(const Evidence& e) {
  const auto z = e.results.table("flat_press_normal_projection", "trajectory.csv").at("pz_m");
  return {{"",
           {{"step", {e.results.number("corner_normal_projection", "metrics.force_step_max_N")}},
            {"step_shortest", {e.results.number("corner_shaped_stiffness", "metrics.force_step_max_N")}},
            {"pressed", {-z.back()}},
            {"depth", {e.results.number("flat_press_normal_projection", "metrics.depth_max_m")}},
            {"depth_shortest", {e.results.number("flat_press_shaped_stiffness", "metrics.depth_max_m")}}}}};
}

Finding judge_normal_projection(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool jumps = m["step"] >= kForceSteps * m["step_shortest"];
  const bool faithful = std::abs(m["depth"] / m["pressed"] - 1.0) <= kFollows;
  const bool saturates = m["depth_shortest"] < kSaturates * m["pressed"];
  return {decide(jumps && faithful && saturates, jumps),
          fmt::format(
              "largest force step {:.2f} N against {:.2f} N; pressed in by {:.2f} mm: depth {:.2f} against {:.2f} mm",
              m["step"], m["step_shortest"], 1e3 * m["pressed"], 1e3 * m["depth"], 1e3 * m["depth_shortest"]),
          fmt::format("the force {} at the corner; on the flat the normal projection {}, the shortest distance {}",
                      jumps ? "jumps" : "does not jump", faithful ? "does not saturate" : "does not follow",
                      saturates ? "does" : "does not")};
}

// ---- F2: the energy of the weighed over the plain springs, and how many steps the peg takes to leave.

constexpr double kEnergyKept = 1e-9;
constexpr double kFaster = 5.0;

/// The ratio farthest from 1 of all contact sets that give a force at all.
double tandpasta_energy_ratio(const Evidence& e) {
  PrecisionOptions options;
  options.cache = e.cache;
  const Scenario scenario = drill_in_hole(e.scenario("task2_rotate_signed_distance"));
  const auto law = make_tandpasta({});
  double ratio = 1.0;
  for (ContactBuffer& set : contact_sets(scenario, options, 64)) {
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

Measured measure_tandpasta(const Evidence& e) {
  return {{"",
           {{"energy_ratio", {tandpasta_energy_ratio(e)}},
            {"steps", {e.results.number("peg_in_hole_2d_tandpasta", "steps")}},
            {"steps_shaped", {e.results.number("peg_in_hole_2d_shaped_stiffness", "steps")}}}}};
}

Finding judge_tandpasta(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool unchanged = std::abs(m["energy_ratio"] - 1.0) <= kEnergyKept;
  const bool jumps = kFaster * m["steps"] <= m["steps_shaped"];
  return {decide(unchanged && jumps, unchanged || jumps),
          fmt::format("energy ratio {:.12g}; the peg leaves after {} steps, {} with stiffness shaping",
                      m["energy_ratio"], m["steps"], m["steps_shaped"]),
          fmt::format("the weights {} the elastic energy; the peg {}", unchanged ? "keep" : "change",
                      jumps ? "is thrown out" : "is not thrown out")};
}

constexpr Claim kClaims[] = {
    {.id = "F1",
     .place = "F.1, Fig. F.4",
     .claim = "the normal projection does not saturate on a flat, and jumps at a corner",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format(
               "reproduced: {} times the force step, follows the press where the shortest distance saturates",
               in_words(kForceSteps));
         },
     .measure = measure_normal_projection,
     .judge = judge_normal_projection},
    {.id = "F2",
     .place = "F.2, Fig. F.5",
     .claim = "tandpasta keeps the elastic energy and throws the tool out",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: energy unchanged to {}, the peg leaves {} times as fast", plain(kEnergyKept),
                              in_words(kFaster));
         },
     .measure = measure_tandpasta,
     .judge = judge_tandpasta},
};

}  // namespace

std::span<const Claim> appendix_f_optional_algorithms() {
  return kClaims;
}

}  // namespace hapbench
