#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"

/// Claims of appendix D: the man-machine experiments with simulated subjects.
namespace hapbench {
namespace {

struct MeasuredColumn {
  const char* name;       ///< of the measure
  const char* column;     ///< of targets.csv
  const char* published;  ///< part of the id
};
constexpr const char *kSuccessRate = "success rate", *kModelForce = "model force";
constexpr MeasuredColumn kMeasures[] = {{kSuccessRate, "removed", "success"},
                                        {"completion time", "time_s", "time"},
                                        {kModelForce, "model_force_N", "force"},
                                        {"speed", "speed_m_per_s", "speed"}};

/// Largest difference of a measure, but for the force that subjects regulate, to the published one, in standard errors
/// of the difference; half a unit of the last published digit is added.
constexpr double kStandardErrors = 2.0;  // in words in the rule

/// The columns of targets.csv; NaN where there is no value.
using TargetTable = std::map<std::string, std::vector<double>>;

/// Mean of a column over each subject's targets at a place; subjects without a value are left out.
std::map<double, double> subject_means(const TargetTable& targets, const char* column, double place) {
  std::map<double, std::vector<double>> values;
  for (std::size_t i = 0; i < targets.at("place").size(); ++i) {
    const double value = targets.at(column)[i];
    if (targets.at("place")[i] != place || std::isnan(value)) continue;
    values[targets.at("subject")[i]].push_back(value);
  }
  std::map<double, double> means;
  for (const auto& [subject, all] : values) means[subject] = mean_of(all);
  return means;
}

/// A case for each measure, with the mean of each subject that has one with either algorithm.
Measured measure(const Evidence& e, const std::string& task, double place) {
  const TargetTable original = e.table(task + "_original_averaging", "targets.csv"),
                    shaped = e.table(task + "_shaped_stiffness", "targets.csv");
  Measured measured;
  for (const MeasuredColumn& column : kMeasures) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{column.name, {}});
    const auto a = subject_means(original, column.column, place), b = subject_means(shaped, column.column, place);
    std::vector<double>&of_original = m.values["original"], &of_shaped = m.values["shaped"];
    for (const auto& [subject, value] : a) {
      if (!b.contains(subject)) continue;
      of_original.push_back(value);
      of_shaped.push_back(b.at(subject));
    }
  }
  return measured;
}

/// Half a unit of the last digit with which the thesis prints a mean.
double half_a_digit(double printed) {
  const std::string text = plain(printed);
  const auto point = text.find('.');
  // Every mean of appendix D is printed with a digit behind the point, 1.0 too.
  const auto digits = point == std::string::npos ? 1 : text.size() - point - 1;
  return 0.5 * math::pow(10.0, -static_cast<double>(digits));
}

struct Compared {
  bool agrees = false;  ///< significant or not, and in the direction, as published
  bool near = false;    ///< near the published ones; true of the force, which subjects regulate
  double t = 0.0;
  double farthest = 0.0;  ///< larger difference to a published mean [standard errors of the difference]
};

Compared compare(const MeasuredCase& m, const PublishedNumbers& published, const std::string& id,
                 bool published_difference) {
  const auto* column = std::ranges::find(kMeasures, m.name, &MeasuredColumn::name);
  const std::vector<double>&original = m.all("original"), &shaped = m.all("shaped");
  const PublishedNumber& of_original = published[id + "." + column->published + ".original_averaging"];
  const PublishedNumber& of_shaped = published[id + "." + column->published + ".shaped_stiffness"];
  const auto difference = [](const std::vector<double>& ours, const PublishedNumber& p) {
    const double beyond = std::max(std::abs(mean_of(ours) - p.mean) - half_a_digit(p.mean), 0.0);
    return beyond == 0.0 ? 0.0 : beyond / math::hypot(p.spread, standard_error(ours));
  };
  Compared c;
  c.t = paired_t(original, shaped);
  const bool significant = std::abs(c.t) > critical_t(original.empty() ? 0 : original.size() - 1);
  // Means that would be printed alike do not differ, however small their scatter.
  const double margin = half_a_digit(of_original.mean) + half_a_digit(of_shaped.mean);
  const bool alike = std::abs(mean_of(original) - mean_of(shaped)) <= margin;
  c.agrees =
      published_difference ? significant && c.t * (of_original.mean - of_shaped.mean) > 0.0 : !significant || alike;
  c.farthest = std::max(difference(original, of_original), difference(shaped, of_shaped));
  c.near = m.name == kModelForce || c.farthest <= kStandardErrors;
  return c;
}

/// `id` is that of a claim D1 to D4; `published_difference`: whether the thesis found one.
Finding judge_experiment(const Measured& measured, const PublishedNumbers& published, const std::string& id,
                         bool published_difference) {
  bool all = true, success = false;
  std::string text, deviating, farthest;
  double most = -1.0;
  for (const MeasuredCase& m : measured) {
    const Compared c = compare(m, published, id, published_difference);
    if (c.farthest > most) farthest = m.name;
    most = std::max(most, c.farthest);
    // No difference is a claim about a level: two rates of nothing do not differ, either.
    if (m.name == kSuccessRate) success = c.agrees && (published_difference || c.near);
    const std::vector<double>&a = m.all("original"), &b = m.all("shaped");
    if (!c.agrees) {
      append_item(deviating, m.name, ", ");
    } else if (!c.near) {
      append_item(deviating,
                  fmt::format("{} {:.2g} and {:.2g}, not near the published ones", m.name, mean_of(a), mean_of(b)),
                  ", ");
    }
    all = all && c.agrees && c.near;
    append_item(text, fmt::format("{} {:.2g} ± {:.1g} vs {:.2g} ± {:.1g} (t = {:.3g})", m.name, mean_of(a),
                                  standard_error(a), mean_of(b), standard_error(b), c.t));
  }
  return {decide(all, success),
          (deviating.empty() ? std::string("every measure agrees with the published one in direction and significance")
                             : "other than published: " + deviating) +
              fmt::format("; the {} differs most, by {:.2g} standard errors of the difference; subjects regulate the "
                          "gauge, so the mean force is nearly an input",
                          farthest, most),
          text};
}

constexpr const char *kVertical = "vertical_peg_in_hole", *kRotational = "rotational_peg_in_hole";

// ---- D7: what the wall does to either algorithm. A case for each target.

Measured measure_wall(const Evidence& e) {
  Measured measured = {measure(e, kVertical, 0.0).front(), measure(e, kVertical, 1.0).front()};
  measured[0].name = "centre";
  measured[1].name = "side";
  return measured;
}

Finding judge_wall(const Measured& measured, const PublishedNumbers& published) {
  bool direction = true, near = true;
  std::string text;
  for (const auto& [name, law] : {std::pair("original", "original_averaging"), std::pair("shaped", kProposedLaw)}) {
    const std::vector<double>&centre = measured.at(0).all(name), &side = measured.at(1).all(name);
    const PublishedNumber at_side = published[std::string("D1.success.") + law],
                          at_centre = published[std::string("D2.success.") + law];
    const double change = mean_of(side) - mean_of(centre), expected = at_side.mean - at_centre.mean;
    const double error = math::hypot(math::hypot(at_side.spread, at_centre.spread),
                                     math::hypot(standard_error(side), standard_error(centre)));
    direction = direction && change * expected > 0.0;
    near = near && std::abs(change - expected) <= kStandardErrors * error;
    append_item(text, fmt::format("{} {:.2f} → {:.2f}", law, mean_of(centre), mean_of(side)));
  }
  return {decide(direction && near, direction),
          fmt::format("the wall {}; the changes are {} the published ones",
                      direction ? "helps stiffness shaping and hurts the original algorithm" : "does something else",
                      near ? "near" : "not near"),
          text};
}

// ---- D6: success rates over places of the pilot experiments. A case for each, with both algorithms' subject means.

constexpr double kHardlyAny = 0.1;
constexpr double kMostTrials = 0.5;
constexpr double kOffsets[] = {0.4e-3, 0.46e-3, 0.52e-3, 0.58e-3, 0.64e-3, 0.7e-3};  ///< from the hole's axis [m]
constexpr double kHeights[] = {2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 4.5e-3};            ///< over the hole's bottom [m]
constexpr double kHoleDepth = 5e-3;

/// The subjects' success rate at a place: four targets each, and no other place, since a drill that is lost at one
/// would spoil the others.
double success_rate(const Evidence& e, const std::string& scenario, const Vec3& place) {
  const Result run = e.run(scenario, {fmt::format("hand.task.places_m=[[{},{},{}]]", place.x(), place.y(), place.z()),
                                      "hand.task.targets_per_place=4", "hand.trials=1"});
  return place_metrics(run.targets).at(0).success_rate.mean;
}

Measured measure_pilots(const Evidence& e) {
  Measured measured;
  const auto add = [&](const char* name, const std::string& task, double value, const Vec3& place) {
    measured.push_back({name,
                        {{"value", {value}},
                         {"original", {success_rate(e, task + "_original_averaging", place)}},
                         {"shaped", {success_rate(e, task + "_shaped_stiffness", place)}}}});
  };
  for (const double offset : kOffsets) add("offset", kVertical, offset, {offset, 0.0, -kHoleDepth});
  for (const double height : kHeights) add("height", kRotational, height, {0.0, 0.0, height - kHoleDepth});
  return measured;
}

/// What the pilots of one kind show.
struct PilotResult {
  bool easy = false;       ///< most targets are removed somewhere
  bool beyond = false;     ///< more than hardly any are removed beyond the published place
  bool somewhere = false;  ///< a place where hardly any is removed, but most with stiffness shaping

  bool as_published() const { return easy && !beyond; }
  const char* said() const {
    return as_published() ? "as published" : somewhere ? "another threshold" : "no threshold";
  }
};

Finding judge_pilots(const Measured& measured, const PublishedNumbers& published) {
  PilotResult offset, height;
  for (const MeasuredCase& m : measured) {
    const bool hardly_any = m["original"] <= kHardlyAny, is_offset = m.name == "offset";
    PilotResult& pilot = is_offset ? offset : height;
    const bool hard =
        is_offset ? m["value"] > published["D6.offset"].at_most : m["value"] < published["D6.height"].at_least;
    pilot.easy = pilot.easy || m["original"] >= kMostTrials;
    pilot.beyond = pilot.beyond || (hard && !hardly_any);
    pilot.somewhere = pilot.somewhere || (hardly_any && m["shaped"] >= kMostTrials);
  }
  return {decide(offset.as_published() && height.as_published(), offset.somewhere || height.somewhere),
          fmt::format("offset: {}; height: {}", offset.said(), height.said())};
}

}  // namespace

std::vector<ClaimRule> appendix_d_experiments() {
  return {{"D1", [](const Evidence& e) { return measure(e, kVertical, 1.0); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_experiment(m, p, "D1", true); }},
          {"D2", [](const Evidence& e) { return measure(e, kVertical, 0.0); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_experiment(m, p, "D2", false); }},
          {"D3", [](const Evidence& e) { return measure(e, kRotational, 0.0); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_experiment(m, p, "D3", true); }},
          {"D4", [](const Evidence& e) { return measure(e, kRotational, 1.0); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_experiment(m, p, "D4", true); }},
          {"D6", measure_pilots, judge_pilots},
          {"D7", measure_wall, judge_wall}};
}

}  // namespace hapbench
