#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of appendix D: the man-machine experiments with simulated subjects.
namespace hapbench {
namespace {

struct Column {
  const char* name;       ///< of the measure
  const char* column;     ///< of targets.csv
  const char* published;  ///< part of the id
};
constexpr const char* kSuccessRate = "success rate";
constexpr Column kMeasures[] = {{kSuccessRate, "removed", "success"},
                                {"completion time", "time_s", "time"},
                                {"model force", "model_force_N", "force"},
                                {"speed", "speed_m_per_s", "speed"}};

/// How far a success rate may be from the published one: standard errors of the difference, beside what the published
/// digits leave open.
constexpr double kStandardErrors = 2.0;

/// Mean of a column over each subject's targets at a place; none for a subject without a value.
std::map<double, double> subject_means(const std::map<std::string, std::vector<double>>& targets, const char* column,
                                       double place) {
  std::map<double, std::pair<double, double>> sums;
  for (std::size_t i = 0; i < targets.at("place").size(); ++i) {
    const double value = targets.at(column)[i];
    if (targets.at("place")[i] != place || std::isnan(value)) continue;
    auto& [sum, count] = sums[targets.at("subject")[i]];
    sum += value;
    count += 1.0;
  }
  std::map<double, double> means;
  for (const auto& [subject, sum] : sums) means[subject] = sum.first / sum.second;
  return means;
}

/// A case for each measure; with the mean of each subject that has one with either algorithm.
Measured measure(const Evidence& e, const std::string& task, double place) {
  const auto original = e.results.table(task + "_original_averaging", "targets.csv");
  const auto shaped = e.results.table(task + "_shaped_stiffness", "targets.csv");
  Measured measured;
  for (const Column& column : kMeasures) {
    MeasuredCase& m = measured.emplace_back();
    m.name = column.name;
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
  const auto digits = point == std::string::npos ? 0 : text.size() - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(digits));
}

/// What one measure says beside the published one.
struct Compared {
  bool agrees = false;  ///< significant or not, and in the direction, as published
  bool near = false;    ///< a success rate near the published one; true of other measures
  double t = 0.0;
};

Compared compare(const MeasuredCase& m, const PublishedNumbers& published, const std::string& id,
                 bool published_difference) {
  const auto column =
      std::find_if(std::begin(kMeasures), std::end(kMeasures), [&m](const Column& c) { return c.name == m.name; });
  const std::vector<double>&original = m.all("original"), &shaped = m.all("shaped");
  const Published of_original = published.mean_and_spread(id + "." + column->published + ".original_averaging");
  const Published of_shaped = published.mean_and_spread(id + "." + column->published + ".shaped_stiffness");
  const auto near = [](const std::vector<double>& ours, const Published& p) {
    return std::abs(mean_of(ours) - p.mean) <=
           kStandardErrors * std::hypot(p.spread, standard_error(ours)) + half_a_digit(p.mean);
  };
  Compared c;
  c.t = paired_t(original, shaped);
  const bool significant = std::abs(c.t) > critical_t(original.empty() ? 0 : original.size() - 1);
  // Means that would be printed alike are no difference, however little they scatter.
  const double margin = half_a_digit(of_original.mean) + half_a_digit(of_shaped.mean);
  const bool alike = std::abs(mean_of(original) - mean_of(shaped)) <= margin;
  c.agrees =
      published_difference ? significant && c.t * (of_original.mean - of_shaped.mean) > 0.0 : !significant || alike;
  c.near = m.name != kSuccessRate || (near(original, of_original) && near(shaped, of_shaped));
  return c;
}

/// `published_difference`: whether the thesis found one.
Finding judge(const Measured& measured, const PublishedNumbers& published, const std::string& id,
              bool published_difference) {
  bool all = true, success = false;
  std::string text, deviating;
  for (const MeasuredCase& m : measured) {
    const Compared c = compare(m, published, id, published_difference);
    if (m.name == kSuccessRate) success = c.agrees;
    if (!c.agrees || !c.near) deviating += (deviating.empty() ? "" : ", ") + m.name;
    all = all && c.agrees && c.near;
    const std::vector<double>&a = m.all("original"), &b = m.all("shaped");
    text += fmt::format("{}{} {:.2g} ± {:.1g} vs {:.2g} ± {:.1g} (t = {:.3g})", text.empty() ? "" : "; ", m.name,
                        mean_of(a), standard_error(a), mean_of(b), standard_error(b), c.t);
  }
  return {decide(all, success), text,
          (deviating.empty() ? std::string("every measure agrees with the published one in direction and significance")
                             : "other than published: " + deviating) +
              " (subjects regulate the gauge, so the mean force is nearly an input)"};
}

std::string rule(const PublishedNumbers&) {
  return fmt::format(
      "reproduced: every measure significant or not (paired t, {}) as published, in its direction, means that would be "
      "printed alike counting as no difference, and success rates within {} standard errors of the difference and half a "
      "printed digit; in kind: the success rate is significant or not as published",
      percent(kSignificance), in_words(kStandardErrors));
}

constexpr const char *kVertical = "vertical_peg_in_hole", *kRotational = "rotational_peg_in_hole";

// ---- D6: success rates over places that the pilot experiments went through. A case for each place, with the subjects'
// mean of both algorithms.

constexpr double kHardlyAny = 0.1;
constexpr double kMostTrials = 0.5;
constexpr double kOffsets[] = {0.4e-3, 0.46e-3, 0.52e-3, 0.58e-3, 0.64e-3, 0.7e-3};  ///< from the hole's axis [m]
constexpr double kHeights[] = {2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 4.5e-3};            ///< over the hole's bottom [m]
constexpr double kHoleDepth = 5e-3;

struct Pilot {
  const char* task;
  const char* name;
  std::span<const double> values;
  Vec3 (*place)(double value);
};
constexpr Pilot kPilots[] = {
    {kVertical, "offset", kOffsets, [](double x) { return Vec3(x, 0.0, -kHoleDepth); }},
    {kRotational, "height", kHeights, [](double z) { return Vec3(0.0, 0.0, z - kHoleDepth); }},
};

/// Success rates at the places of a pilot: four targets each of every subject, a place at a time, since a drill that is
/// lost at one place would spoil the others.
std::vector<double> success_rates(const Evidence& e, const Pilot& pilot, const std::string& algorithm) {
  std::vector<double> rates;
  for (const double value : pilot.values) {
    const Vec3 p = pilot.place(value);
    const std::string overrides[] = {fmt::format("hand.task.places_m=[[{},{},{}]]", p.x(), p.y(), p.z()),
                                     "hand.task.targets_per_place=4", "hand.trials=1"};
    const RunReport report = e.run(std::string(pilot.task) + "_" + algorithm, overrides);
    rates.push_back(place_metrics(report.targets).at(0).success_rate.mean);
  }
  return rates;
}

Measured measure_thresholds(const Evidence& e) {
  Measured measured;
  for (const Pilot& pilot : kPilots) {
    const auto original = success_rates(e, pilot, "original_averaging"),
               shaped = success_rates(e, pilot, "shaped_stiffness");
    for (std::size_t i = 0; i < pilot.values.size(); ++i) {
      measured.push_back(
          {pilot.name, {{"value", {pilot.values[i]}}, {"original", {original[i]}}, {"shaped", {shaped[i]}}}});
    }
  }
  return measured;
}

/// What one pilot shows.
struct Threshold {
  bool as_published = true;  ///< hardly any target beyond the published place, most at the easiest
  bool somewhere = false;    ///< a place where hardly any is removed, but most with stiffness shaping
};

Threshold threshold(const std::vector<const MeasuredCase*>& places, const std::function<bool(double)>& is_hard) {
  Threshold found;
  double easiest = 0.0;
  for (const MeasuredCase* m : places) {
    const bool hardly_any = (*m)["original"] <= kHardlyAny;
    if (is_hard((*m)["value"]) && !hardly_any) found.as_published = false;
    if (hardly_any && (*m)["shaped"] >= kMostTrials) found.somewhere = true;
    easiest = std::max(easiest, (*m)["original"]);
  }
  found.as_published = found.as_published && easiest >= kMostTrials;
  return found;
}

Finding judge_thresholds(const Measured& measured, const PublishedNumbers& published) {
  std::map<std::string, std::vector<const MeasuredCase*>> places;
  std::string text;
  for (const MeasuredCase& m : measured) {
    places[m.name].push_back(&m);
    text += fmt::format("{}{} {:.2f} mm: {:.2f} vs {:.2f}", text.empty() ? "" : "; ", m.name, 1e3 * m["value"],
                        m["original"], m["shaped"]);
  }
  const double furthest = published["D6.offset"].at_most, lowest = published["D6.height"].at_least;
  const Threshold offset = threshold(places["offset"], [furthest](double x) { return x > furthest; });
  const Threshold height = threshold(places["height"], [lowest](double z) { return z < lowest; });
  const auto say = [](const Threshold& t) {
    return t.as_published ? "as published" : t.somewhere ? "another threshold" : "no threshold";
  };
  return {decide(offset.as_published && height.as_published, offset.somewhere || height.somewhere),
          "success of the original algorithm vs stiffness shaping: " + text,
          fmt::format("offset: {}; height: {}", say(offset), say(height))};
}

constexpr Claim kAppendixDExperiments[] = {
    {.id = "D1",
     .place = "D.4.2, Table A.1, Fig. D.7",
     .claim = "vertical task, side target: stiffness shaping does better in every measure",
     .published = "success 0.32 ± 0.09 vs 0.97 ± 0.02; time 7.78 ± 0.66 vs 3.63 ± 0.58 s; "
                  "force 2.28 ± 0.19 vs 1.79 ± 0.15 N; speed 0.009 ± 0.001 vs 0.002 ± 0.0001 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kVertical, 1.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D1", true); },
     .costly = true},
    {.id = "D2",
     .place = "D.4.2, Table A.2, Fig. D.7",
     .claim = "vertical task, central target: no significant difference",
     .published = "success 0.64 ± 0.13 vs 0.63 ± 0.19; time 6.09 ± 0.92 vs 6.47 ± 1.17 s; "
                  "force 1.63 ± 0.16 vs 1.65 ± 0.18 N; speed 0.002 vs 0.002 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kVertical, 0.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D2", false); },
     .costly = true},
    {.id = "D3",
     .place = "D.4.3, Table A.3, Fig. D.8",
     .claim = "rotational task, 3 mm: stiffness shaping does better in every measure",
     .published = "success 0.044 ± 0.044 (printed 0.004 ± 0.004) vs 1.0; time 9.7 ± 0.30 vs 2.20 ± 0.26 s; "
                  "force 3.2 ± 0.24 vs 1.88 ± 0.21 N; speed 0.03 ± 0.004 vs 0.002 ± 0.0004 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kRotational, 0.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D3", true); },
     .costly = true},
    {.id = "D4",
     .place = "D.4.3, Table A.4, Fig. D.8",
     .claim = "rotational task, 4 mm: stiffness shaping does better in every measure",
     .published = "success 0.44 ± 0.11 vs 0.99 ± 0.01; time 7.01 ± 0.85 vs 2.28 ± 0.34 s; "
                  "force 2.24 ± 0.11 vs 1.83 ± 0.15 N; speed 0.014 ± 0.001 vs 0.002 ± 0.0003 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kRotational, 1.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D4", true); },
     .costly = true},
    {.id = "D5",
     .place = "D.4.1, Fig. D.6",
     .claim = "subjects find the proposed algorithm less laborious (questionnaires)",
     .published = "NASA-TLX 63.45 ± 8.34 against 29.24 ± 6.92 (t 2.836); 66.37 ± 7.54 against 6.73 ± 2.96 (t 6.657)",
     .rule = [](const PublishedNumbers&) { return std::string("needs people"); },
     .measure = [](const Evidence&) { return Measured(); },
     .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
       return {Verdict::not_reproducible, "", "simulated subjects feel nothing and fill in no forms"};
     }},
    {.id = "D6",
     .place = "D.2.1, D.3.1",
     .claim =
         "with the original algorithm hardly any target further out than 0.52 mm, or lower than 3 mm, can be removed",
     .published = "0.52 mm, 3 mm (pilot experiments)",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format(
               "reproduced: success of the original algorithm at most {0} beyond, and at least {1} at the easiest place, for "
               "offset and height; in kind: somewhere at most {0} where stiffness shaping has at least {1}, for offset or "
               "height",
               percent(kHardlyAny), percent(kMostTrials));
         },
     .measure = measure_thresholds,
     .judge = judge_thresholds,
     .costly = true},
};

}  // namespace

std::span<const Claim> appendix_d_experiments() {
  return kAppendixDExperiments;
}

}  // namespace hapbench
