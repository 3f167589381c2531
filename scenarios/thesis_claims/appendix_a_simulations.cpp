#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "scenarios/studies/stability/stability_limits.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of appendix A: the planar peg, the springs, the stability limits.
namespace hapbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// ---- A1: the planar peg. A case for each algorithm.

constexpr double kVibratesMore = 5.0;

Measured measure_peg_motion(const Evidence& e) {
  Measured measured;
  for (const std::string algorithm : {"original_averaging", "shaped_stiffness"}) {
    const std::string name = "peg_in_hole_2d_" + algorithm;
    measured.push_back({algorithm,
                        {{"velocity_variation", {e.results.number(name, "metrics.velocity_total_variation_m_per_s")}},
                         {"force_reversals", {e.results.number(name, "metrics.force_reversals")}}}});
  }
  return measured;
}

Finding judge_peg_motion(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase &original = measured.at(0), &shaped = measured.at(1);
  const double variation = original["velocity_variation"] / shaped["velocity_variation"];
  const bool vibrates = variation >= kVibratesMore;
  const bool reverses = original["force_reversals"] >= kVibratesMore * shaped["force_reversals"];
  return {decide(vibrates && reverses, variation > 1.0),
          fmt::format("velocity varies by {:.3g} against {:.3g} m/s, the force reverses {} against {} times",
                      original["velocity_variation"], shaped["velocity_variation"], original["force_reversals"],
                      shaped["force_reversals"]),
          fmt::format("the original algorithm's velocity varies {:.3g} times as much", variation)};
}

// ---- A2, A3: the springs without and with limits. A case for each algorithm.

/// The algorithms that have scenarios of the springs.
constexpr const char* kAlgorithms[] = {"original_averaging", "summation",        "mean",
                                       "virtual_coupling",   "shaped_stiffness", "tandpasta",
                                       "normal_projection",  "exact_shaping"};
constexpr const char* kProposed = "shaped_stiffness";

/// A run has settled within this share of the distance at the start.
constexpr double kSettled = 0.01;
constexpr double kSameTime = 0.1;
constexpr double kTakesLonger = 1.5;

/// The last time further than kSettled [s]; infinite for a run that does not complete or ends further out.
double settling_time(const Evidence& e, const std::string& group, const std::string& algorithm) {
  const std::string name = group + "_" + algorithm;
  const auto table = e.results.table(name, "trajectory.csv");
  const auto &x = table.at("px_m"), &y = table.at("py_m"), &time = table.at("time_s");
  const double far = kSettled * std::hypot(x.front(), y.front());
  if (e.results.summary(name)["outcome"] != "completes" || std::hypot(x.back(), y.back()) > far) return kNever;
  double settling = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::hypot(x[i], y[i]) > far) settling = time[i];
  }
  return settling;
}

Measured measure_springs_unlimited(const Evidence& e) {
  Measured measured;
  for (const char* algorithm : kAlgorithms)
    measured.push_back({algorithm, {{"settling", {settling_time(e, "springs_unlimited", algorithm)}}}});
  return measured;
}

Finding judge_springs_unlimited(const Measured& runs, const PublishedNumbers&) {
  std::string failed;
  std::size_t arrived = 0;
  for (const MeasuredCase& run : runs) {
    if (run["settling"] < kNever) {
      ++arrived;
    } else {
      failed += (failed.empty() ? "" : ", ") + run.name;
    }
  }
  return {decide(arrived == runs.size(), 2 * arrived > runs.size()),
          fmt::format("{} of {} algorithms reach the origin", arrived, runs.size()),
          failed.empty() ? "every algorithm settles" : "with 100 springs a side these do not: " + failed};
}

Measured measure_springs_limited(const Evidence& e) {
  Measured measured;
  for (const char* algorithm : kAlgorithms) {
    measured.push_back({algorithm,
                        {{"unlimited", {settling_time(e, "springs_unlimited", algorithm)}},
                         {"limited", {settling_time(e, "springs_limited", algorithm)}}}});
  }
  return measured;
}

Finding judge_springs_limited(const Measured& runs, const PublishedNumbers&) {
  bool keeps = false;
  std::string slower, times;
  for (const MeasuredCase& run : runs) {
    const double before = run["unlimited"], after = run["limited"];
    if (run.name == kProposed) keeps = std::abs(after / before - 1.0) <= kSameTime;
    if (run.name != kProposed && before < kNever && after >= kTakesLonger * before)
      slower += (slower.empty() ? "" : ", ") + run.name;
    times += fmt::format("{}{} {:.3g} -> {:.3g} s", times.empty() ? "" : ", ", run.name, before, after);
  }
  return {decide(keeps && !slower.empty(), keeps), "settling time without and with limits: " + times,
          fmt::format("the proposed algorithm {} its performance; {}", keeps ? "keeps" : "does not keep",
                      slower.empty() ? "no other one becomes slow" : "slow with the limits: " + slower)};
}

// ---- A4: the stability limits. A case for each published figure.

struct Figure {
  const char* name;
  const char* published;  ///< id
};
constexpr Figure kUndampedStiffness = {"K_max (B = 0)", "A4.stiffness"};
constexpr Figure kDampingAlone = {"B_max (K = 0)", "A4.damping"};
constexpr Figure kDampedStiffness = {"K_max (B from zeta)", "A4.stiffness.damped"};
constexpr Figure kDampingThere = {"B there", "A4.damping.damped"};
constexpr Figure kFigures[] = {kUndampedStiffness, kDampingAlone, kDampedStiffness, kDampingThere};

constexpr double kEqualLimits = 0.02;
constexpr double kAlikeLimits = 0.2;

Measured measure_stability_limits(const Evidence& e) {
  Measured measured;
  const auto add = [&measured](const Figure& figure, double value) {
    measured.push_back({figure.name, {{"limit", {value}}}});
  };
  for (const StabilityLimit& limit : stability_limits(e.scenario("single_spring"))) {
    if (limit.which == StabilityCase::stiffness_undamped) add(kUndampedStiffness, limit.simulation);
    if (limit.which == StabilityCase::damping_alone) add(kDampingAlone, limit.simulation);
    if (limit.which != StabilityCase::stiffness_damped) continue;
    add(kDampedStiffness, limit.simulation);
    add(kDampingThere, limit.damping_at_limit);
  }
  return measured;
}

Finding judge_stability_limits(const Measured& measured, const PublishedNumbers& published) {
  double worst = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    const auto figure =
        std::find_if(std::begin(kFigures), std::end(kFigures), [&m](const Figure& f) { return f.name == m.name; });
    worst = std::max(worst, std::abs(m["limit"] / published[figure->published].mean - 1.0));
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", m.name, m["limit"]);
  }
  return {decide(worst <= kEqualLimits, worst <= kAlikeLimits), text,
          fmt::format("the largest difference to the published figures is {:.2g} %", 100.0 * worst)};
}

constexpr Claim kClaims[] = {
    {.id = "A1",
     .place = "A.1.2, Fig. A.2",
     .claim = "the original algorithm vibrates in the planar peg-in-hole, stiffness shaping is smooth",
     .published = "visible vibration against smooth motion",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: velocity varies, and the force reverses, at least {} times as much",
                              in_words(kVibratesMore));
         },
     .measure = measure_peg_motion,
     .judge = judge_peg_motion},
    {.id = "A2",
     .place = "A.2, Fig. A.4",
     .claim = "without limits every algorithm brings the springs to the origin",
     .published = "every algorithm",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: every algorithm settles within {}; in kind: most do", percent(kSettled));
         },
     .measure = measure_springs_unlimited,
     .judge = judge_springs_unlimited},
    {.id = "A3",
     .place = "A.2, Fig. A.5",
     .claim = "with limits the proposed algorithm keeps its performance, others become under-damped",
     .published = "B_max 100 N s/m, F_max 30 N",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format(
               "reproduced: shaped stiffness settles as before ({}), another takes {} as long again or "
               "never settles",
               percent(kSameTime), in_words(kTakesLonger - 1.0));
         },
     .measure = measure_springs_limited,
     .judge = judge_springs_limited},
    {.id = "A4",
     .place = "A.3, root locus",
     .claim = "largest stable stiffness and damping at 0.5 ms",
     .published = "1.6e6 N/m (B = 0), 400 N s/m (K = 0), 433 000 N/m with B = 291 N s/m",
     .rule = [](const PublishedNumbers&) { return fmt::format("reproduced: all within {}", percent(kEqualLimits)); },
     .measure = measure_stability_limits,
     .judge = judge_stability_limits},
};

}  // namespace

std::span<const Claim> appendix_a_simulations() {
  return kClaims;
}

}  // namespace hapbench
