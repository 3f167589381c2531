#include <cmath>
#include <map>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/rules.hpp"

/// Claims of appendix D: the man-machine experiments with simulated subjects.
namespace hapbench {
namespace {

struct Column {
  const char* name;       ///< of the measure
  const char* column;     ///< of targets.csv
  const char* published;  ///< part of the id
};
constexpr Column kMeasures[] = {{"success rate", "removed", "success"},
                                {"completion time", "time_s", "time"},
                                {"model force", "model_force_N", "force"},
                                {"speed", "speed_m_per_s", "speed"}};

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

Finding judge(const Evidence& e, const std::string& task, double place, const std::string& id,
              bool published_difference) {
  const auto original = e.results.table(task + "_original_averaging", "targets.csv");
  const auto shaped = e.results.table(task + "_shaped_stiffness", "targets.csv");
  std::vector<PairedMeasure> measures;
  for (const Column& column : kMeasures) {
    PairedMeasure m;
    m.name = column.name;
    const auto a = subject_means(original, column.column, place), b = subject_means(shaped, column.column, place);
    for (const auto& [subject, value] : a) {
      if (!b.contains(subject)) continue;
      m.original.push_back(value);
      m.shaped.push_back(b.at(subject));
    }
    m.published_original = e.published.mean_and_spread(id + "." + column.published + ".original_averaging");
    m.published_shaped = e.published.mean_and_spread(id + "." + column.published + ".shaped_stiffness");
    measures.push_back(std::move(m));
  }
  return judge_experiment(measures, published_difference);
}

Finding judge_side(const Evidence& e) {
  return judge(e, "vertical_peg_in_hole", 1.0, "D1", true);
}
Finding judge_centre(const Evidence& e) {
  return judge(e, "vertical_peg_in_hole", 0.0, "D2", false);
}
Finding judge_low(const Evidence& e) {
  return judge(e, "rotational_peg_in_hole", 0.0, "D3", true);
}
Finding judge_high(const Evidence& e) {
  return judge(e, "rotational_peg_in_hole", 1.0, "D4", true);
}
Finding judge_questionnaires(const Evidence&) {
  return {Verdict::not_reproducible, "", "simulated subjects feel nothing and fill in no forms"};
}

constexpr const char* kRule =
    "reproduced: every measure significant or not (paired t, 5 %) as published, in its direction, success rates within "
    "two "
    "standard errors + 0.1; in kind: the success rate is";

constexpr Claim kClaims[] = {
    {"D1", "D.4.2, Table A.1, Fig. D.7", "vertical task, side target: stiffness shaping does better in every measure",
     "success 0.32 +- 0.09 vs 0.97 +- 0.02; time 7.78 +- 0.66 vs 3.63 +- 0.58 s; force 2.28 +- 0.19 vs 1.79 +- 0.15 N; "
     "speed "
     "0.009 +- 0.001 vs 0.002 +- 0.0001 m/s",
     kRule, judge_side},
    {"D2", "D.4.2, Table A.2, Fig. D.7", "vertical task, central target: no significant difference",
     "success 0.64 +- 0.13 vs 0.63 +- 0.19; time 6.09 +- 0.92 vs 6.47 +- 1.17 s; force 1.63 +- 0.16 vs 1.65 +- 0.18 N; "
     "speed "
     "0.002 vs 0.002 m/s",
     kRule, judge_centre},
    {"D3", "D.4.3, Table A.3, Fig. D.8", "rotational task, 3 mm: stiffness shaping does better in every measure",
     "success 0.004 +- 0.004 vs 1.0; time 9.7 +- 0.30 vs 2.20 +- 0.26 s; force 3.2 +- 0.24 vs 1.88 +- 0.21 N; speed "
     "0.03 +- "
     "0.004 vs 0.002 +- 0.0004 m/s",
     kRule, judge_low},
    {"D4", "D.4.3, Table A.4, Fig. D.8", "rotational task, 4 mm: stiffness shaping does better in every measure",
     "success 0.44 +- 0.11 vs 0.99 +- 0.01; time 7.01 +- 0.85 vs 2.28 +- 0.34 s; force 2.24 +- 0.11 vs 1.83 +- 0.15 N; "
     "speed "
     "0.014 +- 0.001 vs 0.002 +- 0.0003 m/s",
     kRule, judge_high},
    {"D5", "D.4.1, Fig. D.6", "subjects find the proposed algorithm less laborious (questionnaires)",
     "effort 63 against 29 and 66 against 7 of 100", "needs people", judge_questionnaires},
};

}  // namespace

std::span<const Claim> experiment_claims() {
  return kClaims;
}

}  // namespace hapbench
