#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"

/// Error estimates of the metrics of one run.
namespace hapbench {

/// Returns error estimates of `metrics`, which are of the question's scene with `overrides`: the largest change of each
/// metric in runs with half the step, with half the point spacing, and with depth evaluated at every step. A metric
/// that such a run lacks has no entry. Adds the number of runs to `runs`.
TuneMetrics known_errors(const TuneQuestion& question, const std::vector<std::string>& overrides,
                         const TuneMetrics& metrics, std::size_t& runs);

}  // namespace hapbench
