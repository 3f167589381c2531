#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "scenarios/studies/stability/stability_limits.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/measurements.hpp"

/// Claim of A.1: the planar peg.
/// Claims of A.2: a mass on many springs.
/// Claim of A.3: the stability limits of the integrator.
namespace hapbench {
namespace {

// ---- A1: the original algorithm and stiffness shaping without friction, which Table A.1 does not list, with that of
// the trainer, and over tilts at the start and speeds of tilting.

constexpr double kTilts[] = {0.02, 0.05, 0.1, 0.2};
constexpr double kRates[] = {0.3, 0.6, 1.2, 3.0};
constexpr const char *kOriginal = "original_averaging", *kShaped = "shaped_stiffness";

MeasuredCase peg(const Evidence& e, const std::string& scene, const std::string& algorithm, const std::string& name,
                 std::span<const std::string> overrides = {}) {
  return vibration(algorithm + ", " + name, e.run(scene + algorithm, overrides).summary);
}

Measured measure_peg_motion(const Evidence& e) {
  const std::string frictionless = "peg_in_hole_2d_frictionless_";
  Measured measured;
  for (const char* algorithm : {kOriginal, kShaped}) measured.push_back(peg(e, frictionless, algorithm, "no friction"));
  for (const char* algorithm : {kOriginal, kShaped})
    measured.push_back(peg(e, "peg_in_hole_2d_", algorithm, "the trainer's friction"));
  for (const double tilt : kTilts) {
    for (const double rate : kRates) {
      const std::string overrides[] = {
          fmt::format(R"(motion.orientation.tilt_rad={{"type":"ramp","start":{},"rate_per_s":{}}})", tilt, rate)};
      for (const char* algorithm : {kOriginal, kShaped})
        measured.push_back(peg(e, frictionless, algorithm, fmt::format("{} rad, {} rad/s", tilt, rate), overrides));
    }
  }
  return measured;
}

Finding judge_peg_motion(const Measured& measured, const PublishedNumbers&) {
  constexpr std::size_t kMap = 4;  // pairs before it: without friction, with it
  std::size_t more = 0, much_more = 0, pairs = 0;
  for (std::size_t i = kMap; i + 1 < measured.size(); i += 2) {
    ++pairs;
    if (vibrates_more(measured[i], measured[i + 1])) ++more;
    if (vibrates_much_more(measured[i], measured[i + 1])) ++much_more;
  }
  const MeasuredCase &original = measured.at(0), &shaped = measured.at(1);
  const Measured shown(measured.begin(), measured.begin() + kMap);
  return {
      decide(vibrates_much_more(original, shaped), vibrates_more(original, shaped)), vibrations_text(shown),
      fmt::format("without friction the original algorithm's velocity varies {:.3g} times as much, with the trainer's "
                  "friction {:.3g} times; of {} tilts and speeds without friction it vibrates much more at {} and "
                  "more at {}",
                  original["velocity_variation"] / shaped["velocity_variation"],
                  measured.at(2)["velocity_variation"] / measured.at(3)["velocity_variation"], pairs, much_more, more)};
}

}  // namespace

std::vector<Claim> appendix_a_planar_peg() {
  return {
      {.id = "A1",
       .place = "A.1.2, Fig. A.2",
       .claim = "the original algorithm vibrates in the planar peg-in-hole, stiffness shaping is smooth",
       .published = "obvious vibration against smooth motion",
       .rule = vibration_rule() + " as with stiffness shaping, with the parameters of Table A.1; in kind: more of both",
       .measure = measure_peg_motion,
       .judge = judge_peg_motion},
  };
}

namespace {

/// The algorithms of the thesis. The normal projection is missing: on springs it equals stiffness shaping.
constexpr const char* kAlgorithms[] = {"original_averaging", "summation",        "mean",
                                       "virtual_coupling",   "shaped_stiffness", "tandpasta"};
constexpr std::size_t kPairs = 100;  ///< of Table A.3

/// Describes how a mass comes to rest.
struct Approach {
  bool arrives = false;    ///< at the end within kArrived of the origin
  double overshoot = 0.0;  ///< furthest beyond either axis [m]
  double swings = 0.0;     ///< crossings of the axes by more than kArrived
};
constexpr double kArrived = 0.01;

class Swings {
 public:
  /// Counts a change to the other side of zero, once it is `far` from it.
  void add(double x, double far) {
    if (std::abs(x) < far) return;
    if (x * side_ < 0.0) ++count_;
    side_ = x;
  }
  double count() const { return count_; }

 private:
  double side_ = 0.0, count_ = 0.0;
};

struct SpringScene {
  const char* scenario;  ///< springs_unlimited or springs_limited
  std::size_t pairs;
  std::optional<bool> signed_depths = {};  ///< none: as the scenario has it
};

Approach approach(const Evidence& e, const SpringScene& scene, const std::string& algorithm) {
  const std::size_t upward = std::max<std::size_t>(1, scene.pairs / 10);
  std::vector<std::string> overrides = {fmt::format("environment.groups.0.count={}", scene.pairs),
                                        fmt::format("environment.groups.1.count={}", scene.pairs),
                                        fmt::format("environment.groups.2.count={}", upward),
                                        // 4 s are long enough for the slowest algorithm, which creeps.
                                        "time.steps=8000", "record.ratio_iterations=[]"};
  if (scene.signed_depths) overrides.push_back(fmt::format("environment.signed={}", *scene.signed_depths));
  const LoadedScenario loaded = e.load(fmt::format("{}_{}", scene.scenario, algorithm), overrides);
  const double far = kArrived * loaded.scenario.initial.position.norm();
  const auto rows = static_cast<std::uint64_t>(loaded.scenario.time.steps);
  Approach result;
  Swings x, y;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    const Vec3& p = row.tool.pose.position;
    // The start is in the negative quadrant.
    result.overshoot = std::max({result.overshoot, p.x(), p.y()});
    x.add(p.x(), far);
    y.add(p.y(), far);
    // A run that diverges does not reach its last row.
    result.arrives = row.step + 1 == rows && p.norm() <= far;
  });
  result.swings = x.count() + y.count();
  return result;
}

// ---- A2: the algorithms that arrive. A case for each algorithm; "arrives" and the number of pairs over numbers of
// pairs and both readings of the depth: signed, or its absolute value along the displacement (2.3: d >= 0).

constexpr std::size_t kPairCounts[] = {1, 2, 4, 10, 30, kPairs};

Measured measure_springs_unlimited(const Evidence& e) {
  Measured measured;
  for (const bool signed_depths : {true, false}) {
    for (const std::size_t pairs : kPairCounts) {
      MeasuredCase& m = measured.emplace_back();
      m.name = signed_depths ? "depths signed" : "depths ≥ 0";
      m.values["pairs"] = {static_cast<double>(pairs)};
      for (const char* algorithm : kAlgorithms) {
        const Approach a = approach(e, {"springs_unlimited", pairs, signed_depths}, algorithm);
        m.values[algorithm] = {a.arrives ? 1.0 : 0.0};
      }
    }
  }
  return measured;
}

std::string missing(const MeasuredCase& m) {
  std::string names;
  for (const char* algorithm : kAlgorithms) {
    if (m[algorithm] == 0.0) append_item(names, algorithm, ", ");
  }
  return names;
}

std::string arriving(const std::string& missing) {
  return missing.empty() ? "all arrive" : "all but " + missing;
}

Finding judge_springs_unlimited(const Measured& measured, const PublishedNumbers&) {
  bool all = false, some = false;
  std::string text, sign, last;
  for (const MeasuredCase& m : measured) {
    const std::string who = missing(m);
    if (who.empty()) (m["pairs"] == static_cast<double>(kPairs) ? all : some) = true;
    if (m.name != sign) {
      append_item(text, fmt::format("{}: {} with {:g}", m.name, arriving(who), m["pairs"]), " pairs; ");
    } else if (who != last) {
      text += fmt::format(" pairs, {} with {:g}", arriving(who), m["pairs"]);
    } else {
      text += fmt::format(", {:g}", m["pairs"]);
    }
    sign = m.name;
    last = who;
  }
  text += " pairs";
  return {
      decide(all, some), text,
      "100 pairs of 88.5 N s/m are 17 700 N s/m, 22 times the 2 M / Δt = 800 N s/m that A.3 allows, so the plain sum "
      "must diverge there"};
}

// ---- A3: overshoot [m] and swings without and with limits. A case for each algorithm.

/// A performance counts as kept if the overshoot grows by at most this share.
constexpr double kSameOvershoot = 0.1;
constexpr double kFluctuates = 5.0;  ///< swings more than those of the proposed algorithm

Measured measure_springs_limited(const Evidence& e) {
  Measured measured;
  for (const char* algorithm : kAlgorithms) {
    const Approach before = approach(e, {"springs_unlimited", kPairs}, algorithm);
    const Approach after = approach(e, {"springs_limited", kPairs}, algorithm);
    measured.push_back({algorithm,
                        {{"overshoot_unlimited", {before.overshoot}},
                         {"overshoot", {after.overshoot}},
                         {"swings_unlimited", {before.swings}},
                         {"swings", {after.swings}},
                         {"arrives", {after.arrives ? 1.0 : 0.0}}}});
  }
  return measured;
}

Finding judge_springs_limited(const Measured& runs, const PublishedNumbers&) {
  const auto proposed =
      std::find_if(runs.begin(), runs.end(), [](const MeasuredCase& m) { return m.name == kProposedLaw; });
  const bool keeps = proposed->operator[]("arrives") == 1.0 &&
                     (*proposed)["overshoot"] <= (1.0 + kSameOvershoot) * (*proposed)["overshoot_unlimited"] &&
                     (*proposed)["swings"] <= (*proposed)["swings_unlimited"];
  std::string fluctuate, text;
  for (const MeasuredCase& m : runs) {
    if (m["swings"] >= (*proposed)["swings"] + kFluctuates) append_item(fluctuate, m.name, ", ");
    append_item(text, fmt::format("{} {:.2f} mm, {} swings", m.name, 1e3 * m["overshoot"], m["swings"]));
  }
  return {decide(keeps && !fluctuate.empty(), keeps || !fluctuate.empty()),
          "overshoot and swings with the limits: " + text,
          fmt::format("the proposed algorithm {} its performance; {}", keeps ? "keeps" : "does not keep",
                      fluctuate.empty() ? "no other one fluctuates" : "fluctuating: " + fluctuate)};
}

}  // namespace

std::vector<Claim> appendix_a_springs() {
  return {
      {.id = "A2",
       .place = "A.2, Fig. A.4",
       .claim = "without limits every algorithm brings the springs to the origin",
       .published = "every algorithm, 100 pairs",
       .rule = fmt::format(
           "reproduced: each of the thesis's {} algorithms ends within {} of the start's distance from the origin with "
           "the {} pairs of Table A.3, under one reading of the depth's sign; in kind: with fewer pairs",
           std::size(kAlgorithms), percent(kArrived), kPairs),
       .measure = measure_springs_unlimited,
       .judge = judge_springs_unlimited},
      {.id = "A3",
       .place = "A.2, Fig. A.5",
       .claim = "with limits the proposed algorithm keeps its performance, others fluctuate",
       .published = "B_max <A3.damping> N s/m, F_max <A3.force> N",
       .rule = fmt::format(
           "reproduced: with the limits stiffness shaping arrives, overshoots at most {} further and swings no more often "
           "than without, while another algorithm swings {} times more than it; in kind: one of the two",
           percent(kSameOvershoot), in_words(kFluctuates)),
       .measure = measure_springs_limited,
       .judge = judge_springs_limited},
  };
}

namespace {

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
  for (const StabilityLimit& limit : stability_limits(e.load("single_spring").scenario)) {
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
    append_item(text, fmt::format("{} {:.6g}", m.name, m["limit"]), ", ");
  }
  return {decide(worst <= kEqualLimits, worst <= kAlikeLimits), text,
          fmt::format("the largest difference to the published figures is {:.2g} %", 100.0 * worst)};
}

}  // namespace

std::vector<Claim> appendix_a_stability() {
  return {
      {.id = "A4",
       .place = "A.3, root locus",
       .claim = "largest stable stiffness and damping at 0.5 ms",
       .published =
           "<A4.stiffness.mean*1e-6>e6 N/m (B = 0), <A4.damping> N s/m (K = 0), <A4.stiffness.damped.mean*1e-3> 000 N/m with "
           "B = <A4.damping.damped> N s/m",
       .rule = fmt::format("reproduced: all within {}", percent(kEqualLimits)),
       .measure = measure_stability_limits,
       .judge = judge_stability_limits},
  };
}

}  // namespace hapbench
