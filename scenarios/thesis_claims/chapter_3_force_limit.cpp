#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/measurements.hpp"

/// Claims of 2.7, 3.5 and 4.5: the limit of the input force.
namespace hapbench {
namespace {

// ---- L1: displacement into the flat against measured force. slope_times_stiffness: without limit, 1 is proportional
// with the nominal K; onset: measured force from which the displacement stays [N]; plateau_spread: (max - min) / mean
// beyond it.

constexpr double kProportional = 0.02;
constexpr double kOnset = 0.1;
constexpr double kConstant = 0.02;

/// Returns the displacement in each row with contact [m] and appends the measured force of these rows [N].
std::vector<double> displacement(const Evidence& e, const char* scenario, std::vector<double>& force) {
  const auto table = e.results.table(scenario, "trajectory.csv");
  std::vector<double> depth;
  for (std::size_t i = 0; i < table.at("pz_m").size(); ++i) {
    if (table.at("colliding")[i] == 0.0) continue;
    force.push_back(-table.at("fmeas_z_N")[i]);
    depth.push_back(-table.at("pz_m")[i]);
  }
  return depth;
}

Measured measure_force_limit(const Evidence& e) {
  std::vector<double> force_off, force_on;
  const std::vector<double> off = displacement(e, "force_limit_off", force_off);
  const std::vector<double> on = displacement(e, "force_limit_on", force_on);
  // The plateau is that of the last quarter; the onset where the displacement first reaches 99 % of it.
  double plateau = 0.0;
  const std::size_t last = on.size() / 4;
  for (std::size_t i = on.size() - last; i < on.size(); ++i) plateau += on[i] / static_cast<double>(last);
  double onset = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (on[i] >= 0.99 * plateau) onset = std::min(onset, force_on[i]);
  }
  double low = plateau, high = plateau;
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (force_on[i] < onset + 0.2) continue;
    low = std::min(low, on[i]);
    high = std::max(high, on[i]);
  }
  const double stiffness = e.load("force_limit_off").scenario.rendering.stiffness;
  return {{"",
           {{"slope_times_stiffness", {slope(force_off, off) * stiffness}},
            {"onset", {onset}},
            {"plateau_spread", {(high - low) / plateau}}}}};
}

Finding judge_force_limit(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const bool proportional = std::abs(m["slope_times_stiffness"] - 1.0) <= kProportional;
  const bool onset = std::abs(m["onset"] - published["L1.measured"].mean) <= kOnset;
  const bool constant = m["plateau_spread"] <= kConstant;
  return {decide(proportional && onset && constant, proportional && constant),
          fmt::format("slope × K = {:.4f}; with the limit constant to {:.2f} % from {:.2f} N on",
                      m["slope_times_stiffness"], 100.0 * m["plateau_spread"], m["onset"]),
          fmt::format("{} without the limit; {} with it; {}", proportional ? "proportional" : "not proportional",
                      constant ? "constant" : "not constant", onset ? "onset as published" : "onset elsewhere")};
}

// ---- L2: rows of task 2 in which the hand's force is limited and the reaction has reached the limit. The reaction
// grows along v where <v, grad|f|> = -K <f, S v> / |f| > 0; `against` is the share of those rows in which it does not,
// `uphill` how much of the way the tool goes there is uphill.

constexpr double kNearlyAlways = 0.95;
constexpr double kMostly = 0.5;

double force_limit(const Scenario& scenario) {
  return input_force_limit(scenario.device).value();
}

Measured measure_saturated_motion(const Evidence& e) {
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance", kHandAboveLimit);
  const double limit = force_limit(loaded.scenario);
  double rows = 0.0, against = 0.0, way = 0.0, uphill = 0.0;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    const Vec3& spring = row.force.spring;
    // The limiter scales the force to the limit, up to rounding.
    if (row.hand.input.norm() < limit * (1.0 - 1e-12) || spring.norm() < limit) return;
    const Vec3 gradient = -row.force.S * spring;
    const double along = row.tool.velocity.dot(gradient) / gradient.norm();
    rows += 1.0;
    way += row.tool.velocity.norm();
    if (along <= 0.0) against += 1.0;
    uphill += std::max(0.0, along);
  });
  return {{"", {{"rows", {rows}}, {"against", {against / rows}}, {"uphill", {uphill / way}}}}};
}

Finding judge_saturated_motion(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  return {decide(m["against"] >= kNearlyAlways, m["against"] >= kMostly),
          fmt::format("in {:.1f} % of {:.0f} rows at the limit the reaction does not grow along the tool's velocity; "
                      "{:.1f} % of the way there is uphill",
                      100.0 * m["against"], m["rows"], 100.0 * m["uphill"]),
          "the limit bounds the force that drives the tool, which the tool's inertia carries a little beyond"};
}

// ---- L3: a tool shaken in free air. A case for each frequency.

constexpr double kHeavier = 2.0;
constexpr double kSameMass = 0.05;
constexpr double kNormalShaking = 2.0;  ///< [Hz]
constexpr double kFrequencies[] = {1.0, kNormalShaking, 3.0, 4.0};

struct Shaking {
  double apparent_mass = 0.0;  ///< amplitude of the hand's force over that of the handle's acceleration [kg]
  double force_max = 0.0;      ///< of the hand, after the first second [N]
};

/// Fundamental components over the last second, which holds whole periods.
Shaking shake(const Evidence& e, double frequency, bool limited) {
  std::vector<std::string> overrides = {fmt::format("hand.target.x_m.period_s={}", 1.0 / frequency)};
  if (!limited) overrides.push_back("device.force_limit_N=null");
  const LoadedScenario loaded = e.load("shaking_in_free_air", overrides);
  const double omega = 2.0 * std::numbers::pi * frequency;
  const double start = loaded.scenario.time.step * static_cast<double>(loaded.scenario.time.steps) - 1.0;
  std::complex<double> force, position;
  Shaking shaking;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    if (row.time < start) return;
    const auto phase = std::polar(1.0, -omega * row.time);
    force += row.hand_force.x() * phase;
    position += row.handle.position.x() * phase;
    shaking.force_max = std::max(shaking.force_max, row.hand_force.norm());
  });
  shaking.apparent_mass = std::abs(force) / (omega * omega * std::abs(position));
  return shaking;
}

Measured measure_shaking(const Evidence& e) {
  Measured measured;
  for (const double frequency : kFrequencies) {
    const Shaking with = shake(e, frequency, true), without = shake(e, frequency, false);
    measured.push_back({fmt::format("{} Hz", frequency),
                        {{"frequency", {frequency}},
                         {"mass", {with.apparent_mass}},
                         {"mass_unlimited", {without.apparent_mass}},
                         {"force", {with.force_max}}}});
  }
  return measured;
}

Finding judge_shaking(const Measured& measured, const PublishedNumbers& published) {
  const double limit = published["L1.threshold"].mean;
  bool normal = false, heavier = false;
  std::string text;
  for (const MeasuredCase& m : measured) {
    const double factor = m["mass"] / m["mass_unlimited"];
    if (m["frequency"] == kNormalShaking) normal = m["force"] < limit && std::abs(factor - 1.0) <= kSameMass;
    heavier = heavier || factor >= kHeavier;
    append_item(text, fmt::format("{}: {:.2f} N, {:.3f} kg (without limit {:.3f})", m.name, m["force"], m["mass"],
                                  m["mass_unlimited"]));
  }
  return {decide(normal && heavier, heavier), text,
          fmt::format("fast shaking {} like more mass; at {} Hz the force {}", heavier ? "feels" : "does not feel",
                      kNormalShaking, normal ? "stays below the limit and nothing changes" : "reaches the limit")};
}

}  // namespace

std::vector<Claim> chapter_3_force_limit() {
  return {
      {.id = "L1",
       .place = "3.5, Fig. 6",
       .claim = "displacement is proportional to the force without the limit and constant with it",
       .published = "constant beyond <L1.threshold.mean:.1f> N of the hand, <L1.measured> N measured",
       .rule = fmt::format("reproduced: slope within {}, onset within {} N, constant to {}", percent(kProportional),
                           plain(kOnset), percent(kConstant)),
       .measure = measure_force_limit,
       .judge = judge_force_limit},
      {.id = "L2",
       .place = "2.7, C.4.4",
       .claim = "once the input force is limited, the tool moves only where the reaction decreases",
       .published = "no velocity along the gradient of the reaction",
       .rule = fmt::format("reproduced: not uphill in {} of the rows with limited input whose reaction has reached "
                           "the limit; in kind: in {}",
                           percent(kNearlyAlways), percent(kMostly)),
       .measure = measure_saturated_motion,
       .judge = judge_saturated_motion},
      {.id = "L3",
       .place = "4.5, C.4.4",
       .claim = "in free air the limit is felt as inertia when the tool is shaken violently, and not normally",
       .published = "normal shaking stays below <L1.threshold> N",
       .rule = fmt::format(
           "reproduced: {} times the apparent mass at some frequency up to {} Hz; at {} Hz less than <L1.threshold> N and the "
           "same mass within {}; in kind: the first",
           in_words(kHeavier), plain(*std::max_element(std::begin(kFrequencies), std::end(kFrequencies))),
           plain(kNormalShaking), percent(kSameMass)),
       .measure = measure_shaking,
       .judge = judge_shaking},
  };
}

}  // namespace hapbench
