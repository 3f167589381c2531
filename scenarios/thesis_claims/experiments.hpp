#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "results/observe/target_metrics.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// The man-machine experiments of appendix D, measured and judged from targets, whoever the subjects are.
namespace hapbench {

/// The columns of targets.csv that count here: place, subject, removed, time_s, model_force_N, speed_m_per_s; NaN where
/// there is no value.
using TargetTable = std::map<std::string, std::vector<double>>;

/// A case for each measure, with the mean of each subject that has one with either algorithm.
Measured measure_experiment(const TargetTable& original, const TargetTable& shaped, double place);
/// `id` is that of a claim D1 to D4; `published_difference`: whether the thesis found one.
Finding judge_experiment(const Measured& measured, const PublishedNumbers& published, const std::string& id,
                         bool published_difference);

/// Runs an experiment's scenario with overrides, for its targets.
using TargetRuns =
    std::function<std::vector<TargetRow>(const std::string& scenario, std::span<const std::string> overrides)>;

/// D6: a case for each place that the pilot experiments went through, with the success rates of both algorithms.
Measured measure_pilots(const TargetRuns& run);
Finding judge_pilots(const Measured& measured, const PublishedNumbers& published);

/// Half a unit of the last digit with which the thesis prints a mean.
double half_a_digit(double printed);

}  // namespace hapbench
