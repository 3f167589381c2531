#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Runs lists of cases in a single pool of threads.
namespace hapbench {

/// Runs all cases of all lists and returns their results, numbered list by list. `folder` returns the folder for the
/// files of a run; the caller has locked this folder. Without `folder`, no files are written. Runs with the same
/// environment share its point shell. Neither results nor files depend on the number of jobs. The returned results lack
/// Result::targets, a list that may be very long; the files contain this list. `length`: see run_scenario(). Throws
/// IoError and Stopped.
std::vector<Result> run_all(std::span<const Cases> cases, const JobOptions& jobs,
                            const std::function<std::filesystem::path(std::size_t run)>& folder = {},
                            RunLength length = RunLength::full);

}  // namespace hapbench
