#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "results/io/columns.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/measurements.hpp"

/// Claim of 3.6: task 2 against the ideal trajectory. The same recording as T2 and R1.
namespace hapbench {
namespace {

// ---- J1 [m]. A case for each density of the recording, whose taps beyond 2 N are too short for the drill to sink in
// as far as it would; one for the same hand held firm; and some for directions of a firm hand, which the thesis does
// not give.

/// "Around" a published number means at most this many times that number.
constexpr double kAround = 1.2;
constexpr double kDegrees[] = {0.0, 10.0, 20.0, 30.0, 40.0, 50.0};
constexpr const char* kFirm = "the same hand held firm";
constexpr const char* kDirection = "firm hand towards the rim by ";

/// `number(key)` is the number of that name in the section ideal_trajectory of summary.json.
template <class Number>
MeasuredCase errors(const std::string& name, Number number) {
  return {name,
          {{"gentle_lateral_rms", {number("gentle.lateral_error_rms_m")}},
           {"gentle_height", {number("gentle.height_error_mean_m")}},
           {"gentle_interpenetration", {number("gentle.interpenetration_max_m")}},
           {"firm_rows", {number("firm.rows")}},
           {"firm_lateral", {number("firm.lateral_error_max_m")}},
           {"firm_height", {number("firm.height_error_mean_m")}},
           {"firm_interpenetration", {number("firm.interpenetration_max_m")}}}};
}

/// The errors of task 2 with other overrides.
MeasuredCase firm_errors(const Evidence& e, const std::string& name, const std::vector<std::string>& overrides) {
  const RunSummary summary = e.run("task2_rotate_signed_distance", overrides).summary;
  const MetricList& metrics = summary.section("ideal_trajectory")->metrics;
  return errors(name, [&metrics](const std::string& key) {
    return number_of(value_of(metrics, key)).value_or(std::numeric_limits<double>::quiet_NaN());
  });
}

Measured measure_ideal_trajectory(const Evidence& e) {
  Measured measured;
  for (const std::string density : {"signed_distance", "binary"}) {
    measured.push_back(errors(density, [&](const std::string& key) {
      return e.results.number("task2_rotate_" + density, "ideal_trajectory." + key);
    }));
  }
  std::vector<std::string> overrides = kHandAboveLimit;
  measured.push_back(firm_errors(e, kFirm, overrides));
  overrides.emplace_back();
  for (const double degrees : kDegrees) {
    overrides.back() = fmt::format("hand.angle_rad={}", degrees * std::numbers::pi / 180.0);
    measured.push_back(firm_errors(e, kDirection + plain(degrees), overrides));
  }
  return measured;
}

/// The reason why the rows beyond 2 N are not as published; empty if they are.
std::string firm_deviation(const MeasuredCase& m, const PublishedNumbers& published) {
  if (m["firm_rows"] == 0.0) return "no row in contact with more than 2 N";
  if (m["firm_lateral"] > kAround * published["J1.lateral"].mean) return "off the line with more than 2 N";
  if (m["firm_interpenetration"] > kAround * published["J1.depth"].mean) return "sinks in further";
  return "";
}

/// The same for all rows of a recording.
std::string deviation(const MeasuredCase& m, const PublishedNumbers& published) {
  if (m["gentle_lateral_rms"] > published["J1.lateral"].mean) return "off the line below 2 N";
  if (m["gentle_interpenetration"] > kAround * published["J1.depth"].mean) return "sinks in further below 2 N";
  if (std::abs(m["firm_height"]) <= std::abs(m["gentle_height"])) return "no more offset in height above 2 N";
  return firm_deviation(m, published);
}

Finding judge_ideal_trajectory(const Measured& measured, const PublishedNumbers& published) {
  bool recordings = true, firm = true;
  std::string text, why, directions;
  for (const MeasuredCase& m : measured) {
    if (m.name.starts_with(kDirection)) {
      if (firm_deviation(m, published).empty()) {
        append_item(directions, m.name.substr(std::string(kDirection).size()), ", ");
      }
      continue;
    }
    const bool is_firm = m.name == kFirm;
    const std::string problem = is_firm ? firm_deviation(m, published) : deviation(m, published);
    (is_firm ? firm : recordings) &= problem.empty();
    text += text.empty() ? m.name : "; " + m.name;
    if (!is_firm) {
      text += fmt::format(": below 2 N lateral error {:.2f} mm rms, height off by {:.2f} mm on average",
                          1e3 * m["gentle_lateral_rms"], 1e3 * m["gentle_height"]);
    }
    text += fmt::format(
        "{} above 2 N lateral error at most {:.2f} mm, inside by at most {:.2f} mm, height off by {:.2f} mm",
        is_firm ? ":" : ",", 1e3 * m["firm_lateral"], 1e3 * m["firm_interpenetration"], 1e3 * m["firm_height"]);
    append_item(why, fmt::format("{}: {}", m.name, problem.empty() ? "as published" : problem));
  }
  return {decide(recordings && firm, recordings), text,
          fmt::format("{}. Of firm hands {} degrees from straight down it holds for {}", why, fmt::join(kDegrees, ", "),
                      directions.empty() ? "none" : directions)};
}

}  // namespace

std::vector<Claim> chapter_3_ideal_trajectory() {
  return {
      {.id = "J1",
       .place = "3.6, Fig. 7",
       .claim =
           "below 2 N the tip follows the ideal trajectory; above, its height is off, but hardly its distance to the "
           "hole's axis, and it sinks in a little",
       .published =
           "lateral error around <J1.lateral.mean*1000> mm, penetration at most around <J1.depth.mean*1000> mm; no number for the height",
       .rule = fmt::format(
           "reproduced: lateral error at most <J1.lateral.mean*1000> mm rms below 2 N and <J1.lateral.mean*{0}> mm above, "
           "never further inside than <J1.depth.mean*{0}> mm, height further off above 2 N than below, at both densities, "
           "and above 2 N the same when the hand is held firm; in kind: all but the last",
           1e3 * kAround),
       .measure = measure_ideal_trajectory,
       .judge = judge_ideal_trajectory},
  };
}

}  // namespace hapbench
