#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Runs lists of cases in one pool.
namespace hapbench {

/// Runs all cases of a list, numbered one after the other, and writes the files of each into the folder that `folder`
/// names, or none without it. Runs in one environment share its shell. Neither reports nor files depend on the number
/// of jobs. Reports have no targets, of which there may be very many; files have them. Throws IoError and Stopped.
std::vector<Result> run_all(std::span<const Cases> cases, const JobOptions& jobs,
                            const std::function<std::filesystem::path(std::size_t run)>& folder = {});

}  // namespace hapbench
