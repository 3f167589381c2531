#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/run_batch.hpp"

namespace hapbench {

/// What leagues and maps show when nothing is asked for: what the hand feels, and how deep the tool sinks in.
inline constexpr std::string_view kDefaultMetrics[] = {"force_rms_above_30Hz_N", "force_step_p99_N", "depth_max_m"};
/// The same where every run has a reference force to be compared with: magnitude, direction, artefacts, noise.
inline constexpr std::string_view kFidelityMetrics[] = {"fidelity.force_error_relative",
                                                        "fidelity.force_direction_error_rad",
                                                        "fidelity.force_artefact_share", "force_rms_above_30Hz_N"};
/// kDefaultMetrics, separated by commas.
std::string default_metrics_text();

/// True for the name of an outcome after which a run's numbers say nothing about its algorithm (OutcomeInfo).
bool is_failure(std::string_view outcome);

/// The runs of a finished batch with these metrics (default: kFidelityMetrics if every run has a reference force, else
/// kDefaultMetrics). A run has failed when its outcome is a failure or is not expected by its scenario.
LeagueRuns league_runs(const BatchPlan& plan, const BatchReport& report, const std::vector<std::string>& metrics);

}  // namespace hapbench
