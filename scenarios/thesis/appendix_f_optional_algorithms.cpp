#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"

/// Claims of appendix F: the thesis's optional algorithms.
namespace hapbench {
namespace {

// ---- F1: the largest force step at a corner [N], and the depth rendered for a press into a flat [m].

Measured measure_normal_projection(const Evidence& e) {
  const auto z = e.table("flat_press_normal_projection", "trajectory.csv").at("pz_m");
  return {{"",
           {{"step", {e.number("corner_normal_projection", "metrics.force_step_max_N")}},
            {"step_shortest", {e.number("corner_shaped_stiffness", "metrics.force_step_max_N")}},
            {"pressed", {-z.back()}},
            {"depth", {e.number("flat_press_normal_projection", "metrics.depth_max_m")}},
            {"depth_shortest", {e.number("flat_press_shaped_stiffness", "metrics.depth_max_m")}}}}};
}

Finding judge_normal_projection(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase& m = measured.at(0);
  const bool jumps = m["step"] >= threshold(p, "jumps") * m["step_shortest"];
  const bool faithful = std::abs(m["depth"] / m["pressed"] - 1.0) <= threshold(p, "proportional");
  const bool saturates = m["depth_shortest"] < threshold(p, "saturated") * m["pressed"];
  return {decide(jumps && faithful && saturates, jumps), "",
          fmt::format("the force {} at the corner; on the flat the normal projection {}, the shortest distance {}",
                      jumps ? "jumps" : "does not jump", faithful ? "does not saturate" : "does not follow",
                      saturates ? "does" : "does not")};
}

// ---- F2: the energy of the weighed over the plain springs; at some tilts of the planar peg, prescribed, the outward
// force over that of the plain springs in the same pose; and in a converged run without friction (a hundredth of the
// step) the time until the peg leaves [s].

constexpr double kEnergyKept = 1e-9;
constexpr double kBoostTilts[] = {0.08, 0.12, 0.2, 0.4};

/// The ratio furthest from 1 among the contact sets that give a force.
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

/// The outward force over that of the plain springs, at the first row beyond each tilt.
std::vector<double> outward_boosts(const Evidence& e) {
  const LoadedScenario loaded = e.load("tilt_sweep_tandpasta");
  const double stiffness = loaded.scenario.rendering.stiffness;
  std::vector<double> boosts;
  for_each_row(loaded, [&](const StepRecord& row) {
    if (boosts.size() == std::size(kBoostTilts) || row.rendered->empty()) return;
    const double tilt = math::acos(-row.tool.pose.axis.y());
    if (tilt < kBoostTilts[boosts.size()]) return;
    Vec3 plain = Vec3::Zero();
    for (std::size_t i = 0; i < row.rendered->size(); ++i) plain -= row.rendered->depth[i] * row.rendered->gradient(i);
    boosts.push_back(row.force.spring.y() / (stiffness * plain.y()));
  });
  return boosts;
}

Measured measure_tandpasta(const Evidence& e) {
  MeasuredCase m{"", {{"energy_ratio", {tandpasta_energy_ratio(e)}}, {"boosts", outward_boosts(e)}}};
  for (const std::string algorithm : {"tandpasta", "summation", kProposedLaw}) {
    const std::vector<std::string> converged = {"time.step_s=5e-6", "time.steps=200000",
                                                "rendering.friction.mu_s_N_s_per_m=0",
                                                "rendering.friction.mu_f_s_per_m=0", "record.ratio_iterations=[]"};
    m.values[algorithm] = {e.run("peg_in_hole_2d_" + algorithm, converged).duration};
  }
  return {m};
}

Finding judge_tandpasta(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase& m = measured.at(0);
  const std::vector<double>& boosts = m.all("boosts");
  const double least = boosts.empty() ? 0.0 : *std::min_element(boosts.begin(), boosts.end());
  const bool unchanged = std::abs(m["energy_ratio"] - 1.0) <= kEnergyKept;
  return {
      decide(unchanged && least >= threshold(p, "boosted"), unchanged && least > 1.0),
      fmt::format("energy ratio {:.12g}; outward force at tilts of {} rad {:.1f} times that of the plain springs; in a "
                  "converged run the peg leaves after {:.3f} s, with summation after {:.3f}, with stiffness shaping "
                  "after {:.3f}",
                  m["energy_ratio"], fmt::join(kBoostTilts, ", "), fmt::join(boosts, ", "), m["tandpasta"],
                  m["summation"], m["shaped_stiffness"]),
      fmt::format(
          "the weights {} the elastic energy and {} the outward force; that the peg leaves after 5 steps at the "
          "thesis's step is explicit friction blowing up, not the law",
          unchanged ? "keep" : "change", least > 1.0 ? "raise" : "do not raise")};
}

}  // namespace

std::vector<ClaimRule> appendix_f_optional_algorithms() {
  return {
      {"F1", measure_normal_projection, judge_normal_projection},
      {"F2", measure_tandpasta, judge_tandpasta},
  };
}

}  // namespace hapbench
