#include <cmath>
#include <limits>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/rules.hpp"

/// Claims of appendix A: the planar peg, the springs, the stability limits.
namespace hapbench {
namespace {

/// Those that have scenarios of the springs.
constexpr const char* kThesisAlgorithms[] = {"original_averaging", "summation",        "mean",
                                             "virtual_coupling",   "shaped_stiffness", "tandpasta",
                                             "normal_projection",  "exact_shaping"};

PegMotion peg_motion(const Evidence& e, const std::string& algorithm) {
  const std::string name = "peg_in_hole_2d_" + algorithm;
  return {e.results.number(name, "metrics.velocity_total_variation_m_per_s"),
          e.results.number(name, "metrics.force_reversals")};
}

Finding judge_peg(const Evidence& e) {
  return judge_peg_motion(peg_motion(e, "original_averaging"), peg_motion(e, "shaped_stiffness"));
}

SpringRun spring_run(const Evidence& e, const std::string& group, const std::string& algorithm) {
  const std::string name = group + "_" + algorithm;
  const auto table = e.results.table(name, "trajectory.csv");
  const auto &x = table.at("px_m"), &y = table.at("py_m"), &time = table.at("time_s");
  SpringRun run;
  run.algorithm = algorithm;
  run.completes = e.results.summary(name)["outcome"] == "completes";
  run.final_distance = std::hypot(x.back(), y.back());
  const double far = 0.01 * std::hypot(x.front(), y.front());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::hypot(x[i], y[i]) > far) run.settling = time[i];
  }
  if (!run.completes || run.final_distance > far) run.settling = std::numeric_limits<double>::infinity();
  return run;
}

std::vector<SpringRun> spring_runs(const Evidence& e, const std::string& group) {
  std::vector<SpringRun> runs;
  for (const char* algorithm : kThesisAlgorithms) runs.push_back(spring_run(e, group, algorithm));
  return runs;
}

Finding judge_unlimited(const Evidence& e) {
  return judge_springs_unlimited(spring_runs(e, "springs_unlimited"));
}

Finding judge_limited(const Evidence& e) {
  return judge_springs_limited(spring_runs(e, "springs_unlimited"), spring_runs(e, "springs_limited"),
                               "shaped_stiffness");
}

Finding judge_limits(const Evidence& e) {
  const auto limits = stability_limits(load_scenario(find_scenario("single_spring")).scenario);
  std::vector<StabilityFigure> figures;
  for (const StabilityLimit& limit : limits) {
    if (limit.which == StabilityCase::stiffness_undamped)
      figures.push_back({"K_max (B = 0)", limit.simulation, e.published["A4.stiffness"].mean});
    if (limit.which == StabilityCase::damping_alone)
      figures.push_back({"B_max (K = 0)", limit.simulation, e.published["A4.damping"].mean});
    if (limit.which != StabilityCase::stiffness_damped) continue;
    figures.push_back({"K_max (B from zeta)", limit.simulation, e.published["A4.stiffness.damped"].mean});
    figures.push_back({"B there", limit.damping_at_limit, e.published["A4.damping.damped"].mean});
  }
  return judge_stability_limits(figures);
}

constexpr Claim kClaims[] = {
    {"A1", "A.1.2, Fig. A.2", "the original algorithm vibrates in the planar peg-in-hole, stiffness shaping is smooth",
     "visible vibration against smooth motion",
     "reproduced: velocity varies, and the force reverses, at least five times as much", judge_peg},
    {"A2", "A.2, Fig. A.4", "without limits every algorithm brings the springs to the origin", "every algorithm",
     "reproduced: every algorithm settles within 1 %; in kind: most do", judge_unlimited},
    {"A3", "A.2, Fig. A.5", "with limits the proposed algorithm keeps its performance, others become under-damped",
     "B_max 100 N s/m, F_max 30 N",
     "reproduced: shaped stiffness settles as before (10 %), another takes half as long again or never settles",
     judge_limited},
    {"A4", "A.3, root locus", "largest stable stiffness and damping at 0.5 ms",
     "1.6e6 N/m (B = 0), 400 N s/m (K = 0), 433 000 N/m with B = 291 N s/m", "reproduced: all within 2 %",
     judge_limits},
};

}  // namespace

std::span<const Claim> simulation_claims() {
  return kClaims;
}

}  // namespace hapbench
