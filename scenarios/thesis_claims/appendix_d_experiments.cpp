#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/statistics.hpp"
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

/// How far a success rate may be from the published one: standard errors of that, and a margin.
constexpr double kStandardErrors = 2.0;
constexpr double kRateMargin = 0.1;

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
  const auto near = [](double mean, const Published& p) {
    return std::abs(mean - p.mean) <= kStandardErrors * p.spread + kRateMargin;
  };
  Compared c;
  c.t = paired_t(original, shaped);
  const bool significant = std::abs(c.t) > critical_t(original.empty() ? 0 : original.size() - 1);
  c.agrees = published_difference ? significant && c.t * (of_original.mean - of_shaped.mean) > 0.0 : !significant;
  c.near = m.name != kSuccessRate || (near(mean_of(original), of_original) && near(mean_of(shaped), of_shaped));
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
    text += fmt::format("{}{} {:.3g} vs {:.3g} (t = {:.3g})", text.empty() ? "" : "; ", m.name,
                        mean_of(m.all("original")), mean_of(m.all("shaped")), c.t);
  }
  return {decide(all, success), text,
          deviating.empty() ? "every measure agrees with the published one in direction and significance"
                            : "other than published: " + deviating};
}

std::string rule(const PublishedNumbers&) {
  return fmt::format(
      "reproduced: every measure significant or not (paired t, {}) as published, in its direction, success rates within "
      "{} standard errors + {}; in kind: the success rate is",
      percent(kSignificance), in_words(kStandardErrors), plain(kRateMargin));
}

constexpr const char *kVertical = "vertical_peg_in_hole", *kRotational = "rotational_peg_in_hole";

constexpr Claim kClaims[] = {
    {.id = "D1",
     .place = "D.4.2, Table A.1, Fig. D.7",
     .claim = "vertical task, side target: stiffness shaping does better in every measure",
     .published = "success 0.32 +- 0.09 vs 0.97 +- 0.02; time 7.78 +- 0.66 vs 3.63 +- 0.58 s; "
                  "force 2.28 +- 0.19 vs 1.79 +- 0.15 N; speed 0.009 +- 0.001 vs 0.002 +- 0.0001 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kVertical, 1.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D1", true); },
     .costly = true},
    {.id = "D2",
     .place = "D.4.2, Table A.2, Fig. D.7",
     .claim = "vertical task, central target: no significant difference",
     .published = "success 0.64 +- 0.13 vs 0.63 +- 0.19; time 6.09 +- 0.92 vs 6.47 +- 1.17 s; "
                  "force 1.63 +- 0.16 vs 1.65 +- 0.18 N; speed 0.002 vs 0.002 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kVertical, 0.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D2", false); },
     .costly = true},
    {.id = "D3",
     .place = "D.4.3, Table A.3, Fig. D.8",
     .claim = "rotational task, 3 mm: stiffness shaping does better in every measure",
     .published = "success 0.004 +- 0.004 vs 1.0; time 9.7 +- 0.30 vs 2.20 +- 0.26 s; "
                  "force 3.2 +- 0.24 vs 1.88 +- 0.21 N; speed 0.03 +- 0.004 vs 0.002 +- 0.0004 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kRotational, 0.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D3", true); },
     .costly = true},
    {.id = "D4",
     .place = "D.4.3, Table A.4, Fig. D.8",
     .claim = "rotational task, 4 mm: stiffness shaping does better in every measure",
     .published = "success 0.44 +- 0.11 vs 0.99 +- 0.01; time 7.01 +- 0.85 vs 2.28 +- 0.34 s; "
                  "force 2.24 +- 0.11 vs 1.83 +- 0.15 N; speed 0.014 +- 0.001 vs 0.002 +- 0.0003 m/s",
     .rule = rule,
     .measure = [](const Evidence& e) { return measure(e, kRotational, 1.0); },
     .judge = [](const Measured& m, const PublishedNumbers& p) { return judge(m, p, "D4", true); },
     .costly = true},
    {.id = "D5",
     .place = "D.4.1, Fig. D.6",
     .claim = "subjects find the proposed algorithm less laborious (questionnaires)",
     .published = "effort 63 against 29 and 66 against 7 of 100",
     .rule = [](const PublishedNumbers&) { return std::string("needs people"); },
     .measure = [](const Evidence&) { return Measured(); },
     .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
       return {Verdict::not_reproducible, "", "simulated subjects feel nothing and fill in no forms"};
     }},
};

}  // namespace

std::span<const Claim> appendix_d_experiments() {
  return kClaims;
}

}  // namespace hapbench
