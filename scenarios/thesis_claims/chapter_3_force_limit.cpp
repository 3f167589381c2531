#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of chapter 3: the force limit and the ideal trajectory.
namespace hapbench {
namespace {

// ---- L1: displacement into the flat against measured force. slope_times_stiffness: without limit, 1 is proportional;
// onset: measured force from which the displacement stays [N]; plateau_spread: (max - min) / mean beyond it.

constexpr double kProportional = 0.02;
constexpr double kOnset = 0.1;
constexpr double kConstant = 0.02;

/// The displacement in each row with contact [m]; appends the force measured there [N].
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
  const double K = e.results.number("force_limit_off", "metrics.force_max_N") /
                   e.results.number("force_limit_off", "metrics.depth_max_m");
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
  return {{"",
           {{"slope_times_stiffness", {slope(force_off, off) * K}},
            {"onset", {onset}},
            {"plateau_spread", {(high - low) / plateau}}}}};
}

Finding judge_force_limit(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const bool proportional = std::abs(m["slope_times_stiffness"] - 1.0) <= kProportional;
  const bool onset = std::abs(m["onset"] - published["L1.measured"].mean) <= kOnset;
  const bool constant = m["plateau_spread"] <= kConstant;
  return {decide(proportional && onset && constant, proportional && constant),
          fmt::format("slope x K = {:.4f}; with the limit constant to {:.2f} % from {:.2f} N on",
                      m["slope_times_stiffness"], 100.0 * m["plateau_spread"], m["onset"]),
          fmt::format("{} without the limit; {} with it; {}", proportional ? "proportional" : "not proportional",
                      constant ? "constant" : "not constant", onset ? "onset as published" : "onset elsewhere")};
}

// ---- J1: against the ideal trajectory [m].

Measured measure_ideal_trajectory(const Evidence& e) {
  const auto low = [&](const char* key) {
    return e.results.number("ideal_trajectory_low_force", std::string("ideal_trajectory.gentle.") + key);
  };
  const auto high = [&](const char* key) {
    return e.results.number("ideal_trajectory_high_force", std::string("ideal_trajectory.firm.") + key);
  };
  return {{"",
           {{"low_height_rms", {low("height_error_rms_m")}},
            {"low_lateral_rms", {low("lateral_error_rms_m")}},
            {"low_interpenetration", {low("interpenetration_mean_m")}},
            {"high_interpenetration", {high("interpenetration_mean_m")}},
            {"high_interpenetration_max", {high("interpenetration_max_m")}}}}};
}

Finding judge_ideal_trajectory(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const double most = published["J1.depth"].mean;
  const bool follows = std::max(m["low_height_rms"], m["low_lateral_rms"]) <= most;
  const bool bounded = m["high_interpenetration_max"] <= most;
  const bool deeper = m["high_interpenetration"] > m["low_interpenetration"];
  return {
      decide(follows && bounded, follows && deeper),
      fmt::format("low force: height {:.2f} mm rms, lateral {:.2f} mm rms, inside by {:.2f} mm on average; high force: "
                  "{:.2f} mm on average, at most {:.2f} mm",
                  1e3 * m["low_height_rms"], 1e3 * m["low_lateral_rms"], 1e3 * m["low_interpenetration"],
                  1e3 * m["high_interpenetration"], 1e3 * m["high_interpenetration_max"]),
      fmt::format(
          "with low force the tip {} within {:.2f} mm of the ideal trajectory; with high force it falls {} than "
          "{:.2f} mm inside",
          follows ? "stays" : "does not stay", 1e3 * most, bounded ? "less" : "more", 1e3 * most)};
}

constexpr Claim kClaims[] = {
    {.id = "L1",
     .place = "3.5, Fig. 6",
     .claim = "displacement is proportional to the force without the limit and constant with it",
     .published = "constant beyond 2.0 N of the hand, 2.7 N measured",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: slope within {}, onset within {} N, constant to {}", percent(kProportional),
                              plain(kOnset), percent(kConstant));
         },
     .measure = measure_force_limit,
     .judge = judge_force_limit},
    {.id = "J1",
     .place = "3.6, Fig. 7",
     .claim = "the tip follows the ideal trajectory; with more than 2 N it falls inside a little",
     .published = "inside by at most about 0.25 mm",
     .rule =
         [](const PublishedNumbers& published) {
           const std::string most = plain(1e3 * published["J1.depth"].mean);
           return fmt::format(
               "reproduced: low force within {} mm rms, high force inside by at most {} mm; in kind: "
               "low force within, high force deeper",
               most, most);
         },
     .measure = measure_ideal_trajectory,
     .judge = judge_ideal_trajectory},
};

}  // namespace

std::span<const Claim> chapter_3_force_limit() {
  return kClaims;
}

}  // namespace hapbench
