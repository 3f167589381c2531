#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"

/// Claims of appendix D: the man-machine experiments with simulated subjects.
namespace hapbench {
namespace {

/// Names of a quantity that the experiments measure.
struct MeasuredColumn {
  const char* name;       ///< name of the measure
  const char* column;     ///< column of targets.csv
  const char* published;  ///< part of the id of the published number
  const char* unit;       ///< with a leading space; empty for a fraction
};
constexpr const char *kSuccessRate = "success rate", *kModelForce = "model force";
constexpr MeasuredColumn kMeasures[] = {{kSuccessRate, "removed", "success", ""},
                                        {"completion time", "time_s", "time", " s"},
                                        {kModelForce, "model_force_N", "force", " N"},
                                        {"speed", "speed_m_per_s", "speed", " m/s"}};

/// Returns the names of the quantity that a case measures.
const MeasuredColumn& column_of(const MeasuredCase& m) {
  return *std::ranges::find(kMeasures, m.name, &MeasuredColumn::name);
}

/// Largest difference between a measured and a published mean that counts as near [standard errors of the difference].
/// Half a unit of the last published digit is allowed in addition. Does not apply to the force, which subjects
/// regulate.
constexpr double kStandardErrors = 2.0;  // stated in the rule's text

/// The columns of targets.csv by name; NaN for a missing value.
using TargetTable = std::map<std::string, std::vector<double>>;

/// Returns the mean of a column over the targets at a position, for each subject. Omits subjects without a value.
std::map<double, double> subject_means(const TargetTable& targets, const char* column, double position) {
  std::map<double, std::vector<double>> values;
  for (std::size_t i = 0; i < targets.at("place").size(); ++i) {
    const double value = targets.at(column)[i];
    if (targets.at("place")[i] != position || std::isnan(value)) continue;
    values[targets.at("subject")[i]].push_back(value);
  }
  std::map<double, double> means;
  for (const auto& [subject, all] : values) means[subject] = mean_of(all);
  return means;
}

/// Returns one case for each measure, with the means of the subjects that have values with both algorithms.
Measured measure(const Evidence& e, const std::string& task, double position) {
  const TargetTable original = e.table(task + "_original_averaging", "targets.csv"),
                    shaped = e.table(task + "_shaped_stiffness", "targets.csv");
  Measured measured;
  for (const MeasuredColumn& column : kMeasures) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{column.name, {}});
    const auto a = subject_means(original, column.column, position), b = subject_means(shaped, column.column, position);
    std::vector<double>&of_original = m.values["original"], &of_shaped = m.values["shaped"];
    for (const auto& [subject, value] : a) {
      if (!b.contains(subject)) continue;
      of_original.push_back(value);
      of_shaped.push_back(b.at(subject));
    }
  }
  return measured;
}

/// Returns half a unit of the last digit of a mean as printed in the thesis.
double half_a_digit(double printed) {
  const std::string text = plain(printed);
  const auto point = text.find('.');
  // Every mean of appendix D is printed with at least one decimal, also 1.0.
  const auto digits = point == std::string::npos ? 1 : text.size() - point - 1;
  return 0.5 * math::pow(10.0, -static_cast<double>(digits));
}

/// Comparison of a measure with the published values.
struct Compared {
  bool significant = false;  ///< true if the algorithms differ significantly
  bool agrees = false;       ///< true if significance and direction of the difference are as published
  double t = 0.0;            ///< paired t statistic of original minus shaped
  /// Differences of the measured from the published means [standard errors of the difference], beyond the rounding of
  /// the published mean: with the original algorithm, and with stiffness shaping.
  double of_original = 0.0, of_shaped = 0.0;

  /// Returns the larger difference; NaN if a mean is missing.
  double farthest() const {
    return std::isnan(of_original) || std::isnan(of_shaped) ? std::numeric_limits<double>::quiet_NaN()
                                                            : std::max(of_original, of_shaped);
  }
  bool near() const { return farthest() <= kStandardErrors; }
};

/// Returns the published number of a measure with a law. `id`: see judge_experiment().
const PublishedNumber& published_of(const MeasuredCase& m, const PublishedNumbers& published, const std::string& id,
                                    const char* law) {
  return published[fmt::format("{}.{}.{}", id, column_of(m).published, law)];
}

/// Compares a measure with the published values. `id`, `published_difference`: see judge_experiment().
Compared compare(const MeasuredCase& m, const PublishedNumbers& published, const std::string& id,
                 bool published_difference) {
  const std::vector<double>&original = m.all("original"), &shaped = m.all("shaped");
  const PublishedNumber& of_original = published_of(m, published, id, "original_averaging");
  const PublishedNumber& of_shaped = published_of(m, published, id, kProposedLaw);
  const auto difference = [](const std::vector<double>& ours, const PublishedNumber& p) {
    const double beyond = std::max(std::abs(mean_of(ours) - p.mean) - half_a_digit(p.mean), 0.0);
    return beyond == 0.0 ? 0.0 : beyond / math::hypot(p.spread, standard_error(ours));
  };
  Compared c;
  c.t = paired_t(original, shaped);
  c.significant = std::abs(c.t) > critical_t(original.empty() ? 0 : original.size() - 1);
  c.agrees = published_difference ? c.significant && c.t * (of_original.mean - of_shaped.mean) > 0.0 : !c.significant;
  c.of_original = difference(original, of_original);
  c.of_shaped = difference(shaped, of_shaped);
  return c;
}

/// Returns true if a judged measure is as the rule of D1 to D4 requires.
bool is_consistent(const MeasuredCase& m, const Compared& c, bool published_difference) {
  if (m.all("original").empty()) return false;  // no subject has values for both algorithms
  // If the thesis reports no difference, the success rates must also be near the published rates: two rates of 0 do not
  // differ either.
  const bool near = published_difference || m.name != kSuccessRate || c.near();
  return c.agrees && near;
}

/// Returns a number with two significant digits, also if the second is a zero: 0.0020, 10.
std::string two_digits(double value) {
  const std::string text = fmt::format("{:#.2g}", value);
  return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
}

/// Returns the means of a measure with both algorithms.
std::string both_means(const MeasuredCase& m) {
  return fmt::format("{} {} (original) against {}{} (shaping)", m.name, two_digits(mean_of(m.all("original"))),
                     two_digits(mean_of(m.all("shaped"))), column_of(m).unit);
}

/// Returns how a measure that is_consistent() rejects is not as published.
const char* deviation(const MeasuredCase& m, const Compared& c, bool published_difference) {
  if (m.all("original").empty()) return "not compared, because no subject has values for both algorithms";
  return c.agrees                ? "not near the published means"
         : !published_difference ? "a significant difference, unlike in the thesis"
         : c.significant         ? "a difference in the opposite direction"
                                 : "a difference that is not significant";
}

/// Returns the means of a measure that are far from the published means, with the published means; empty if both are
/// near. `id`: see judge_experiment().
std::string far_means(const MeasuredCase& m, const Compared& c, const PublishedNumbers& published,
                      const std::string& id) {
  std::string means;
  const auto add = [&](double deviation, const char* values, const char* law, const char* algorithm) {
    if (deviation <= kStandardErrors) return;
    append_item(means,
                fmt::format("{:.2g}{} with {} (published: {})", mean_of(m.all(values)), column_of(m).unit, algorithm,
                            plain(published_of(m, published, id, law).mean)),
                " and ");
  };
  add(c.of_original, "original", "original_averaging", "the original algorithm");
  add(c.of_shaped, "shaped", kProposedLaw, "stiffness shaping");
  return means.empty() ? "" : m.name + " " + means;
}

/// Returns the paired t statistic as text.
std::string t_text(double t) {
  return std::isfinite(t) ? fmt::format("t = {:.3g}", t) : "no t: the difference is the same for every subject";
}

/// Returns the reason of the verdict. `wrong`: the judged measures that are not as published; `far`: the means that are
/// far from the published means. `published_difference`: see judge_experiment().
std::string experiment_reason(const std::string& wrong, const std::string& far, bool published_difference) {
  std::string reason = !wrong.empty()         ? wrong
                       : published_difference ? "the algorithms differ as published in every judged measure"
                                              : "no judged measure differs significantly between the algorithms";
  if (!far.empty())
    reason +=
        fmt::format(". Some means differ from the published means by more than rounding plus {:g} standard errors: ",
                    kStandardErrors) +
        far;
  return reason;
}

/// Judges an experiment by all its measures except the force. `id`: D1 to D4. `published_difference`: true if the
/// thesis reports a significant difference between the algorithms. The number of the finding has the success rates, and
/// each other measure that is not as published.
Finding judge_experiment(const Measured& measured, const PublishedNumbers& published, const std::string& id,
                         bool published_difference) {
  std::string text, number, unlike_published, far;
  for (const MeasuredCase& m : measured) {
    const std::vector<double>&a = m.all("original"), &b = m.all("shaped");
    const Compared c = compare(m, published, id, published_difference);
    append_item(text, fmt::format("{} {:.2g} ± {:.1g} vs {:.2g} ± {:.1g} ({})", m.name, mean_of(a), standard_error(a),
                                  mean_of(b), standard_error(b), t_text(c.t)));
    if (m.name == kModelForce) continue;
    const bool as_published = is_consistent(m, c, published_difference);
    const char* wrong = as_published ? "" : deviation(m, c, published_difference);
    if (!as_published) append_item(unlike_published, fmt::format("{} is not as published ({})", m.name, wrong));
    if (m.name == kSuccessRate)
      append_item(number, fmt::format("{} {:.2f} (original) against {:.2f} (shaping)", m.name, mean_of(a), mean_of(b)));
    else if (!as_published)
      append_item(number,
                  a.empty() ? fmt::format("{}: {}", m.name, wrong) : fmt::format("{}, {}", both_means(m), wrong));
    if (const std::string means = far_means(m, c, published, id); !means.empty()) append_item(far, means);
  }
  return {in_simulation(unlike_published.empty()), experiment_reason(unlike_published, far, published_difference), text,
          number};
}

/// The earlier rule of D1 to D4 also compared the numbers with the published numbers, and two means that would be
/// printed with the same digits counted as equal. `id`, `published_difference`: see judge_experiment().
Verdict judge_experiment_before(const Measured& measured, const PublishedNumbers& published, const std::string& id,
                                bool published_difference) {
  bool all = true, success = false;
  for (const MeasuredCase& m : measured) {
    const Compared c = compare(m, published, id, published_difference);
    const auto half = [&](const char* law) { return half_a_digit(published_of(m, published, id, law).mean); };
    const double difference = std::abs(mean_of(m.all("original")) - mean_of(m.all("shaped")));
    const bool equal = difference <= half("original_averaging") + half(kProposedLaw);
    const bool agrees = c.agrees || (!published_difference && equal);
    all = all && agrees && (c.near() || m.name == kModelForce);  // subjects regulate the force
    if (m.name == kSuccessRate) success = agrees && (published_difference || c.near());
  }
  return decide(all, success);
}

constexpr const char *kVertical = "vertical_peg_in_hole", *kRotational = "rotational_peg_in_hole";

// ---- D7: the effect of the wall on the success rate with each algorithm. One case for each target: centre and side.

Measured measure_wall(const Evidence& e) {
  Measured measured = {measure(e, kVertical, 0.0).front(), measure(e, kVertical, 1.0).front()};
  measured[0].name = "centre";
  measured[1].name = "side";
  return measured;
}

/// How the success rates change from the central to the side target.
struct EffectOfWall {
  bool direction = true;  ///< true if both changes have the published direction
  bool near = true;       ///< true if both changes equal the published changes within kStandardErrors
  std::string text = {};  ///< the success rates
};

EffectOfWall effect_of_wall(const Measured& measured, const PublishedNumbers& published) {
  EffectOfWall effect;
  for (const auto& [name, law, label] :
       {std::tuple("original", "original_averaging", "original"), std::tuple("shaped", kProposedLaw, "shaping")}) {
    const std::vector<double>&centre = measured.at(0).all(name), &side = measured.at(1).all(name);
    const PublishedNumber at_side = published[std::string("D1.success.") + law],
                          at_centre = published[std::string("D2.success.") + law];
    const double change = mean_of(side) - mean_of(centre), expected = at_side.mean - at_centre.mean;
    const double error = math::hypot(math::hypot(at_side.spread, at_centre.spread),
                                     math::hypot(standard_error(side), standard_error(centre)));
    effect.direction = effect.direction && change * expected > 0.0;
    effect.near = effect.near && std::abs(change - expected) <= kStandardErrors * error;
    append_item(effect.text, fmt::format("{} {:.2f} → {:.2f}", label, mean_of(centre), mean_of(side)));
  }
  return effect;
}

/// The earlier rule of D7 also compared the changes with the published changes.
Verdict judge_wall_before(const Measured& measured, const PublishedNumbers& published) {
  const EffectOfWall effect = effect_of_wall(measured, published);
  return decide(effect.direction && effect.near, effect.direction);
}

Finding judge_wall(const Measured& measured, const PublishedNumbers& published) {
  const EffectOfWall effect = effect_of_wall(measured, published);
  return {in_simulation(effect.direction),
          fmt::format("at the side target, success {}; the changes are {} the published changes",
                      effect.direction ? "rises with stiffness shaping and falls with the original algorithm"
                                       : "does not change in the published directions",
                      effect.near ? "near" : "not near"),
          effect.text, "success rate, centre → side: " + effect.text};
}

// ---- D6: success rates at the target positions of the pilot experiments. One case for each position, with the mean
// over the subjects for both algorithms.

constexpr double kHardlyAnyTarget = 0.1;    ///< largest success rate that counts as "hardly any target is removed"
constexpr double kMajorityOfTargets = 0.5;  ///< smallest success rate that counts as "most targets are removed"
constexpr double kOffsets[] = {0.4e-3,  0.46e-3, 0.52e-3,
                               0.58e-3, 0.64e-3, 0.7e-3};                  ///< distance from the hole's axis [m]
constexpr double kHeights[] = {2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 4.5e-3};  ///< height above the hole's bottom [m]
constexpr double kHoleDepth = 5e-3;                                        ///< [m]

/// Returns the mean success rate of the subjects at one position [m]. Each subject has four targets. Each position has
/// a separate run, because a subject who loses the drill misses all remaining targets.
double success_rate(const Evidence& e, const std::string& scenario, const Vec3& position) {
  const Result run =
      e.run(scenario, {fmt::format("hand.task.places_m=[[{},{},{}]]", position.x(), position.y(), position.z()),
                       "hand.task.targets_per_place=4", "hand.trials=1"});
  return position_metrics(run.targets).at(0).success_rate.mean;
}

Measured measure_pilots(const Evidence& e) {
  Measured measured;
  const auto add = [&](const char* name, const std::string& task, double value, const Vec3& position) {
    measured.push_back({name,
                        {{"value", {value}},
                         {"original", {success_rate(e, task + "_original_averaging", position)}},
                         {"shaped", {success_rate(e, task + "_shaped_stiffness", position)}}}});
  };
  for (const double offset : kOffsets) add("offset", kVertical, offset, {offset, 0.0, -kHoleDepth});
  for (const double height : kHeights) add("height", kRotational, height, {0.0, 0.0, height - kHoleDepth});
  return measured;
}

/// Result of one pilot experiment, which varies either the offset or the height of the targets.
struct PilotResult {
  /// Largest success rates with the original algorithm: at positions beyond the published one, and at the others.
  double beyond = 0.0, within = 0.0;
  /// True if, at some position, hardly any target is removed with the original algorithm, and most targets are removed
  /// with stiffness shaping.
  bool somewhere = false;

  bool complete = true;  ///< false if a rate is NaN, which satisfies no rule

  bool as_published() const { return complete && within >= kMajorityOfTargets && beyond <= kHardlyAnyTarget; }
  const char* text() const {
    return as_published() ? "as published" : somewhere ? "another threshold" : "no threshold";
  }
};

/// Results of the pilot experiments.
struct Pilots {
  PilotResult offset, height;
};

/// Returns true if a position of the offset or height experiment is beyond the published position.
bool is_beyond(const MeasuredCase& m, const PublishedNumbers& published) {
  return m.name == "offset" ? m["value"] > published["D6.offset"].at_most
                            : m["value"] < published["D6.height"].at_least;
}

Pilots pilot_results(const Measured& measured, const PublishedNumbers& published) {
  Pilots pilots;
  for (const MeasuredCase& m : measured) {
    PilotResult& pilot = m.name == "offset" ? pilots.offset : pilots.height;
    pilot.complete = pilot.complete && !std::isnan(m["original"]);
    double& largest = is_beyond(m, published) ? pilot.beyond : pilot.within;
    largest = std::max(largest, m["original"]);
    pilot.somewhere = pilot.somewhere || (m["original"] <= kHardlyAnyTarget && m["shaped"] >= kMajorityOfTargets);
  }
  return pilots;
}

/// The earlier rule of D6 accepted another position than the published one as qualitatively replicated.
Verdict judge_pilots_before(const Measured& measured, const PublishedNumbers& published) {
  const auto [offset, height] = pilot_results(measured, published);
  return decide(offset.as_published() && height.as_published(), offset.somewhere || height.somewhere);
}

Finding judge_pilots(const Measured& measured, const PublishedNumbers& published) {
  const auto [offset, height] = pilot_results(measured, published);
  std::string worse;  // positions at which the success rate is lower with stiffness shaping
  for (const MeasuredCase& m : measured)
    if (m["shaped"] < m["original"])
      append_item(worse,
                  fmt::format("{} {:.2f} mm (shaping {:.2f}, original {:.2f})", m.name, 1e3 * m["value"], m["shaped"],
                              m["original"]),
                  ", ");
  return {
      in_simulation(offset.as_published() && height.as_published()),
      fmt::format("offset: {}; height: {}; positions at which the success rate is lower with stiffness shaping: {}",
                  offset.text(), height.text(), worse.empty() ? "none" : worse),
      "",
      fmt::format(
          "highest success rate with the original algorithm: {:.2f} among targets beyond {} mm, {:.2f} among nearer "
          "targets (vertical task); {:.2f} among targets less than {} mm above the bottom, {:.2f} among higher "
          "targets (rotational task)",
          offset.beyond, plain(published["D6.offset"].at_most * 1e3), offset.within, height.beyond,
          plain(published["D6.height"].at_least * 1e3), height.within)};
}

/// An experiment of appendix D.
struct Experiment {
  const char* id;
  const char* task;
  double position;            ///< index of the target's position
  bool published_difference;  ///< true if the thesis reports a significant difference between the algorithms
};
constexpr Experiment kExperiments[] = {{"D1", kVertical, 1.0, true},
                                       {"D2", kVertical, 0.0, false},
                                       {"D3", kRotational, 0.0, true},
                                       {"D4", kRotational, 1.0, true}};

/// Returns the rule of kExperiments[i].
template <std::size_t i>
ClaimRule experiment() {
  static constexpr Experiment kOf = kExperiments[i];
  return {kOf.id,
          [](const Evidence& e) { return measure(e, kOf.task, kOf.position); },
          [](const Measured& m, const PublishedNumbers& p) {
            return judge_experiment(m, p, kOf.id, kOf.published_difference);
          },
          {[](const Measured& m, const PublishedNumbers& p) {
            return judge_experiment_before(m, p, kOf.id, kOf.published_difference);
          }}};
}

}  // namespace

std::vector<ClaimRule> appendix_d_experiments() {
  return {experiment<0>(),
          experiment<1>(),
          experiment<2>(),
          experiment<3>(),
          {"D6", measure_pilots, judge_pilots, {judge_pilots_before}},
          {"D7", measure_wall, judge_wall, {judge_wall_before}}};
}

}  // namespace hapbench
