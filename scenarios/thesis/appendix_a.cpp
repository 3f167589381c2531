#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of appendix A: the planar peg (A.1), a mass on many springs (A.2), the integrator's stability limits (A.3).
namespace hapbench {
namespace {

// ---- A1: vibration of the original algorithm and of stiffness shaping, without friction (Table A.1 lists no friction)
// and with the friction of the haptic device. The initial tilt and speed are assumptions of this project
// (assumptions.json), which `reproduce --sensitivity` varies.

Measured measure_peg_motion(const Evidence& e) {
  Measured measured;
  for (const auto& [scene, name] : {std::pair("peg_in_hole_2d_frictionless_", "no friction"),
                                    std::pair("peg_in_hole_2d_", "the friction of the haptic device")}) {
    measured.push_back(
        vibration(fmt::format("original_averaging, {}", name), e.run(fmt::format("{}original_averaging", scene))));
    measured.push_back(reference_vibration(fmt::format("{}, {}", kProposedLaw, name),
                                           e.run(fmt::format("{}{}", scene, kProposedLaw))));
  }
  return measured;
}

Finding judge_peg_motion(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase &original = measured.at(0), &shaped = measured.at(1);
  return {decide(vibrates_much_more(original, shaped, p), vibrates_more(original, shaped)),
          fmt::format(
              "the total variation of the velocity with the original algorithm, divided by its value with stiffness "
              "shaping, is {:.3g} without friction and {:.3g} with the friction of the haptic device",
              original["velocity_variation"] / shaped["velocity_variation"],
              measured.at(2)["velocity_variation"] / measured.at(3)["velocity_variation"])};
}

/// The earlier rule of A1 ignored that the run with stiffness shaping may diverge.
Verdict judge_peg_motion_before(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase &original = measured.at(0), shaped = until_divergence(measured.at(1));
  return decide(vibrates_much_more(original, shaped, p), vibrates_more(original, shaped));
}

/// The algorithms of the thesis, except the normal projection, which equals stiffness shaping on springs.
constexpr const char* kAlgorithms[] = {"original_averaging", "summation",        "mean",
                                       "virtual_coupling",   "shaped_stiffness", "tandpasta"};
constexpr std::size_t kPairs = 100;  ///< number of spring pairs in Table A.3

/// Measures how the mass approaches the origin. The tolerance is rule.arrived times the initial distance from the
/// origin.
/// arrives: 1 if the final distance from the origin is at most the tolerance, otherwise 0.
/// overshoot: largest x or y coordinate [m]; the mass starts at negative coordinates.
/// swings: number of sign changes of the x and y coordinates. Coordinates whose magnitude is below the tolerance are
/// ignored.
MeasuredCase approach(const Evidence& e, const std::string& scene, std::size_t pairs, const std::string& algorithm,
                      std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(), {fmt::format("environment.groups.0.count={}", pairs),
                                     fmt::format("environment.groups.1.count={}", pairs),
                                     fmt::format("environment.groups.2.count={}", std::max<std::size_t>(1, pairs / 10)),
                                     // 4 s suffice for the slowest algorithm, which creeps.
                                     "time.steps=8000", "record.ratio_iterations=[]"});
  const LoadedScenario loaded = e.load(fmt::format("{}_{}", scene, algorithm), overrides);
  const double tolerance = threshold(e.published, "arrived") * loaded.scenario.initial.position.norm();
  const auto rows = static_cast<std::uint64_t>(loaded.scenario.time.steps);
  bool arrives = false;
  double overshoot = 0.0, swings = 0.0;
  Vec3 side = Vec3::Zero();  // for each axis: the last coordinate whose magnitude exceeded the tolerance
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    const Vec3& p = row.tool.pose.position;
    for (const Eigen::Index axis : {0, 1}) {
      // The mass starts at negative coordinates, so that a positive coordinate is an overshoot.
      overshoot = std::max(overshoot, p[axis]);
      if (std::abs(p[axis]) < tolerance) continue;
      if (p[axis] * side[axis] < 0.0) swings += 1.0;
      side[axis] = p[axis];
    }
    // A run that diverges does not reach its last row.
    arrives = row.step + 1 == rows && p.norm() <= tolerance;
  });
  return {algorithm,
          {{"pairs", {static_cast<double>(pairs)}},
           {"arrives", {arrives ? 1.0 : 0.0}},
           {"overshoot", {overshoot}},
           {"swings", {swings}}}};
}

// ---- A2: a mass on many springs without force limits. One case for each algorithm, number of pairs of springs, and
// definition of the depth d: signed, or nonnegative (d >= 0, thesis 2.3) with the gradient along the displacement.

constexpr std::size_t kPairCounts[] = {1, 2, 4, 10, 30, kPairs};

Measured measure_springs_unlimited(const Evidence& e) {
  Measured measured;
  for (const bool signed_depths : {true, false}) {
    for (const std::size_t pairs : kPairCounts) {
      for (const char* algorithm : kAlgorithms) {
        measured.push_back(
            approach(e, "springs_unlimited", pairs, algorithm, {fmt::format("environment.signed={}", signed_depths)}));
        measured.back().values["signed"] = {signed_depths ? 1.0 : 0.0};
      }
    }
  }
  return measured;
}

/// Returns true if the mass arrives and swings at most rule.smooth_swings times.
bool is_smooth(const MeasuredCase& m, const PublishedNumbers& p) {
  return m["arrives"] == 1.0 && m["swings"] <= threshold(p, "smooth_swings");
}

/// Returns for each depth definition (true: signed) and number of pairs whether the motion is smooth with all
/// algorithms.
std::map<std::pair<bool, double>, bool> smooth_with_all(const Measured& measured, const PublishedNumbers& p) {
  std::map<std::pair<bool, double>, bool> all_smooth;
  for (const MeasuredCase& m : measured) {
    const auto all = all_smooth.try_emplace({m["signed"] == 1.0, m["pairs"]}, true).first;
    all->second = all->second && is_smooth(m, p);
  }
  return all_smooth;
}

/// The earlier rule of A2: with fewer pairs, the claim counted as qualitatively replicated.
Verdict judge_springs_unlimited_before(const Measured& measured, const PublishedNumbers& p) {
  bool published = false, fewer = false;
  for (const auto& [run, smooth] : smooth_with_all(measured, p)) {
    bool& found = run.second == static_cast<double>(kPairs) ? published : fewer;
    found = found || smooth;
  }
  return decide(published, fewer);
}

Finding judge_springs_unlimited(const Measured& measured, const PublishedNumbers& p) {
  const std::map<std::pair<bool, double>, bool> all_smooth = smooth_with_all(measured, p);
  // The numbers of pairs with a smooth motion, for each depth definition and algorithm.
  std::map<std::pair<bool, std::string>, std::string> smooth_with;
  for (const MeasuredCase& m : measured) {
    std::string& pairs = smooth_with[{m["signed"] == 1.0, m.name}];
    if (is_smooth(m, p)) append_item(pairs, plain(m["pairs"]), ", ");
  }
  std::string text;
  for (const auto& [run, pairs] : smooth_with)
    append_item(text, fmt::format("{}, depths {}: {}", run.second, run.first ? "signed" : "≥ 0",
                                  pairs.empty() ? "none" : pairs));
  bool published = false;
  std::size_t smooth = 0;
  for (const auto& [run, all] : all_smooth) published = published || (all && run.second == static_cast<double>(kPairs));
  for (const char* algorithm : kAlgorithms)
    if (const auto found = smooth_with.find({true, algorithm});
        found != smooth_with.end() && (", " + found->second).ends_with(", " + plain(kPairs)))
      ++smooth;
  return {
      published ? Verdict::replicated : Verdict::contradicted,
      "summation is a counterexample: with 100 pairs, its 200 dampers of 88.5 N s/m have 17 700 N s/m in sum. This is "
      "22 times the stability limit of section A.3, 2 M / Δt = 800 N s/m for M = 0.2 kg, so summation must diverge",
      "numbers of pairs with which the path is smooth, for each algorithm and for depths ≥ 0 or signed depths: " + text,
      fmt::format("{} of {} algorithms are smooth with 100 pairs of springs", smooth, std::size(kAlgorithms))};
}

// Number of pairs of springs with which the motion by the plain sum of forces (algorithm `summation`) is smooth without
// force limits. With 100 pairs, the motion is not smooth even without force limits (A2).
constexpr std::size_t kStablePairs = 4;

/// Measures claim A3. Returns two cases for each algorithm and number of pairs: without force limits, then with force
/// limits.
Measured measure_springs_limited(const Evidence& e) {
  Measured measured;
  for (const std::size_t pairs : {kPairs, kStablePairs}) {
    for (const char* algorithm : kAlgorithms)
      for (const char* scene : {"springs_unlimited", "springs_limited"})
        measured.push_back(approach(e, scene, pairs, algorithm));
  }
  return measured;
}

/// The motion with one algorithm and one number of pairs.
struct WithoutAndWith {
  const MeasuredCase &without, &with;  // without and with the limits

  bool proposed() const { return with.name == kProposedLaw; }
  bool has(std::size_t pairs) const { return with["pairs"] == static_cast<double>(pairs); }
};

std::vector<WithoutAndWith> without_and_with(const Measured& runs) {
  std::vector<WithoutAndWith> motions;
  for (std::size_t i = 0; i + 1 < runs.size(); i += 2) motions.push_back({runs[i], runs[i + 1]});
  return motions;
}

/// Returns whether the proposed algorithm is as good with the limits as without them.
bool keeps_performance(const MeasuredCase& without, const MeasuredCase& with, const PublishedNumbers& p) {
  return with["arrives"] == 1.0 && with["swings"] <= without["swings"] &&
         with["overshoot"] <= (1.0 + threshold(p, "same_overshoot")) * without["overshoot"];
}

/// Returns whether the limits make a smooth motion fluctuate.
bool fluctuates(const MeasuredCase& without, const MeasuredCase& with, const PublishedNumbers& p) {
  return is_smooth(without, p) && with["swings"] >= without["swings"] + threshold(p, "fluctuates");
}

/// Returns the number of swings as text; with `words`, "once" or "18 times" in place of "1" or "18".
std::string swings_of(const MeasuredCase& m, bool words) {
  const std::string number = fmt::format("{}", m["swings"]), arrives = m["arrives"] == 1.0 ? "" : " (does not arrive)";
  if (!words) return number + arrives;
  return (number == "1" ? "once" : number + " times") + arrives;
}

/// Returns the swings of the proposed algorithm, and of the other algorithms that the limits make fluctuate, with this
/// number of pairs.
std::string swings_with(std::size_t pairs, const std::vector<WithoutAndWith>& motions, const PublishedNumbers& p) {
  std::string text;
  for (const WithoutAndWith& m : motions)
    if (m.has(pairs) && (m.proposed() || fluctuates(m.without, m.with, p)))
      append_item(text, fmt::format("{} swings {} without the limits and {} with the limits",
                                    m.proposed() ? "the proposed algorithm" : m.with.name, swings_of(m.without, true),
                                    swings_of(m.with, true)));
  return text;
}

/// Returns how the algorithms that the limits make fluctuate only with few pairs move with the published number of
/// pairs.
std::string instead_of_few(const std::vector<WithoutAndWith>& motions, const PublishedNumbers& p) {
  std::string text;
  for (const WithoutAndWith& few : motions) {
    if (few.has(kPairs) || few.proposed() || !fluctuates(few.without, few.with, p)) continue;
    const bool smooth = std::ranges::any_of(motions, [&](const WithoutAndWith& m) {
      return m.has(kPairs) && m.with.name == few.with.name && is_smooth(m.without, p);
    });
    append_item(text, few.with.name + (smooth ? " does not fluctuate" : " is not smooth even without the limits"),
                ", ");
  }
  return text;
}

Finding judge_springs_limited(const Measured& runs, const PublishedNumbers& p) {
  const std::vector<WithoutAndWith> motions = without_and_with(runs);
  std::string all;
  bool keeps = true, published_pairs = false, few_pairs = false;
  for (const WithoutAndWith& m : motions) {
    if (m.proposed())
      keeps = keeps && keeps_performance(m.without, m.with, p);
    else if (fluctuates(m.without, m.with, p))
      (m.has(kPairs) ? published_pairs : few_pairs) = true;
    append_item(all, fmt::format("{}, {} pairs: {}, then {}", m.with.name, m.with["pairs"], swings_of(m.without, false),
                                 swings_of(m.with, false)));
  }
  const bool few = few_pairs && !published_pairs;
  return {decide(keeps && published_pairs, keeps && few_pairs),
          fmt::format("with the limits, the proposed algorithm {} its performance, and {}",
                      keeps ? "keeps" : "does not keep",
                      published_pairs ? "another algorithm fluctuates with the published number of pairs"
                      : few           ? "another algorithm fluctuates, but only with fewer pairs than published"
                            : "of the other algorithms that are smooth without the limits, none fluctuates with them"),
          "number of swings, with signed depths, first without the limits, then with them: " + all,
          few ? fmt::format("with {0} pairs of springs: {1} ({0} pairs, because with {2} pairs, {3})", kStablePairs,
                            swings_with(kStablePairs, motions, p), kPairs, instead_of_few(motions, p))
              : fmt::format("with {} pairs of springs: {}", kPairs, swings_with(kPairs, motions, p))};
}

// ---- A4: the integrator's stability limits. One case for each published number, in the order of the thesis.

constexpr const char* kSpring = "single_spring";
constexpr double kLimitResolution = 1e-4;
constexpr const char* kUndamped = "rendering.damping_ratio=0";
constexpr double kSameEnergy = 1e-9;  // largest relative change of a conserved energy; stated in the rule's text

/// Returns the largest value of a field at which the motion of a mass on the spring stays bounded after an initial
/// velocity of 1 mm/s.
double largest_bounded(const Evidence& e, const std::string& field, const Range& range,
                       std::vector<std::string> overrides) {
  overrides.insert(overrides.end(), {"time.steps=20000", "initial.velocity_m_per_s=[0.001,0,0]"});
  const Cases scene = e.scene(kSpring, overrides);
  LimitQuestion question = limit_question(scene.scene(0), scene.sets(), field, range);
  question.rule.bounded = true;
  question.search.resolution = kLimitResolution;
  question.between = false;
  return field_limit(question).end.value.value_or(0.0);
}

/// Returns the largest stiffness at which the motion stays bounded [N/m].
double largest_stiffness(const Evidence& e, std::vector<std::string> overrides = {}) {
  return largest_bounded(e, kStiffnessPath, {1e3, 1e9, true}, std::move(overrides));
}
/// Returns the largest damping, without a spring, at which the motion stays bounded [N s/m].
double largest_damping_alone(const Evidence& e) {
  return largest_bounded(e, "rendering.damping_N_s_per_m", {1.0, 1e5, true}, {"rendering.stiffness_N_per_m=0"});
}

/// Returns the damping [N s/m] that the scene's damping ratio gives for a stiffness [N/m].
double damping_at(const Evidence& e, double stiffness) {
  const RenderingConfig rendering = e.load(kSpring).scenario.rendering;
  return 2.0 * rendering.damping_ratio * std::sqrt(stiffness * rendering.mass);
}

Measured measure_stability_limits(const Evidence& e) {
  const double damped = largest_stiffness(e);
  return {{"K_max (B = 0)", {{"limit", {largest_stiffness(e, {kUndamped})}}}},
          {"B_max (K = 0)", {{"limit", {largest_damping_alone(e)}}}},
          {"K_max (B from zeta)", {{"limit", {damped}}}},
          {"B there", {{"limit", {damping_at(e, damped)}}}}};
}

Finding judge_stability_limits(const Measured& measured, const PublishedNumbers& published) {
  constexpr const char* kPublished[] = {"A4.stiffness", "A4.damping", "A4.stiffness.damped", "A4.damping.damped"};
  double worst = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i)
    worst = std::max(worst, std::abs(measured[i]["limit"] / published[kPublished[i]].mean - 1.0));
  return {decide(worst <= threshold(published, "same_limit"), false),
          fmt::format("the largest difference from a published value is {:.2g} %", 100.0 * worst)};
}

/// Measures "stiffness", the largest stable stiffness without damping [N/m]; "there", the damping that the scene's
/// damping ratio gives at this stiffness; and "alone", the largest stable damping without a spring [N s/m].
MeasuredValues measure_damping_at_limit(const Evidence& e) {
  const double stiffness = largest_stiffness(e, {kUndamped});
  return {{"stiffness", {stiffness}}, {"there", {damping_at(e, stiffness)}}, {"alone", {largest_damping_alone(e)}}};
}

Finding judge_damping_at_limit(const MeasuredCase& m, const PublishedNumbers& p) {
  const double there = std::abs(m["there"] / p["A4.damping.undamped"].mean - 1.0);
  const double alone = std::abs(m["alone"] / p["A4.damping"].mean - 1.0);
  const bool before = m["there"] > m["alone"];
  return {decide(before && std::max(there, alone) <= threshold(p, "same_limit"), before),
          before ? "at the largest stiffness that is stable without damping, the damping ratio gives a damping that is "
                   "unstable even without a spring"
                 : "at the largest stiffness that is stable without damping, the damping ratio gives a damping that is "
                   "stable without a spring",
          "",
          fmt::format("at {:.3f}e6 N/m, the prescribed damping ratio needs {:.1f} N s/m, {} {:.1f} N s/m are stable",
                      1e-6 * m["stiffness"], m["there"], before ? "but only" : "and", m["alone"])};
}

// ---- A6: energies of an undamped mass on a spring, whose motion is computed by Eq. A.1.
// mass: largest excess of the gain of kinetic energy over the work of the force on the mass, divided by the initial
//   energy. The work is the sum of F (p_k - p_(k-1)) over the steps so far, with the force F at p_(k-1). Each step
//   changes the excess by -M |dv|^2 / 2, so that the mass alone is passive.
// kept: largest relative change of the modified energy (K x^2 + M v^2 - K dt x v) / 2, which Eq. A.1 conserves.
// naive: largest energy (K x^2 + M v^2) / 2, divided by the initial energy.
// bound: upper bound 1 / (1 - w dt / 2) of `naive`, with the angular frequency w.

MeasuredValues measure_energy(const Evidence& e) {
  const LoadedScenario loaded = e.load(kSpring, {kUndamped});
  const RenderingConfig& rendering = loaded.scenario.rendering;
  const double K = rendering.stiffness, M = rendering.mass, step = loaded.scenario.time.step;
  Vec3 x = Vec3::Zero();
  double start = 0.0, largest = 0.0, modified_start = 0.0, kept = 0.0, work = 0.0, kinetic_start = 0.0, excess = 0.0;
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    const Vec3 &position = row.tool.pose.position, &velocity = row.tool.velocity;
    const double kinetic = 0.5 * M * velocity.squaredNorm(), energy = 0.5 * K * position.squaredNorm() + kinetic;
    const double modified = energy - 0.5 * K * step * position.dot(velocity);
    if (row.step == 0) {
      start = energy;
      modified_start = modified;
      kinetic_start = kinetic;
    } else {
      work += -K * x.dot(position - x);  // the force at the previous position moves the mass to this position
      excess = std::max(excess, kinetic - kinetic_start - work);
    }
    largest = std::max(largest, energy);
    kept = std::max(kept, std::abs(modified / modified_start - 1.0));
    x = position;
  });
  const double half_turn = 0.5 * step * std::sqrt(K / M);
  return {
      {"mass", {excess / start}}, {"kept", {kept}}, {"naive", {largest / start}}, {"bound", {1.0 / (1.0 - half_turn)}}};
}

Finding judge_energy(const MeasuredCase& m, const PublishedNumbers&) {
  const bool mass = m["mass"] <= kSameEnergy, kept = m["kept"] <= kSameEnergy, naive = m["naive"] <= 1.0 + kSameEnergy;
  return {decide(mass && kept && naive, mass || kept),
          fmt::format(
              "the verdict depends on the meaning of energy: the mass alone {} passive; with a spring, a modified "
              "energy {} constant; the energy K x²/2 + M v²/2 oscillates up to 1 / (1 - ω Δt / 2) = {:.4f} times its "
              "initial value",
              mass ? "is" : "is not", kept ? "is" : "is not", m["bound"]),
          "",
          fmt::format("energy that the integrator adds, divided by the initial energy: {:.1g} without a spring "
                      "({}passive), at most {:.3f} with a spring ({}passive)",
                      m["mass"], mass ? "" : "not ", m["naive"] - 1.0, naive ? "" : "not ")};
}

/// The earlier rule of A6 judged one of the three energies.
Verdict judge_energy_before(const Measured& measured, const PublishedNumbers&) {
  return measured.front()["naive"] <= 1.0 + kSameEnergy ? Verdict::replicated : Verdict::contradicted;
}

}  // namespace

std::vector<ClaimRule> appendix_a() {
  return {{"A1", measure_peg_motion, judge_peg_motion, {judge_peg_motion_before}},
          {"A2", measure_springs_unlimited, judge_springs_unlimited, {judge_springs_unlimited_before}},
          {"A3", measure_springs_limited, judge_springs_limited},
          {"A4", measure_stability_limits, judge_stability_limits},
          single_case<measure_damping_at_limit, judge_damping_at_limit>("A5"),
          single_case<measure_energy, judge_energy>("A6", {judge_energy_before})};
}

}  // namespace hapbench
