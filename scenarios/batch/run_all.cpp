#include "scenarios/batch/run_all.hpp"

#include <optional>

#include "scenarios/run/checked_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<Result> run_all(std::span<const Cases> all, const JobOptions& jobs,
                            const std::function<fs::path(std::size_t)>& folder, RunLength length) {
  struct Run {
    const Cases& cases;
    std::size_t i, number;
  };
  std::vector<Run> runs;  // all runs, in execution order
  for (const Cases& cases : all) {
    const std::size_t first = runs.size();
    for (std::size_t position = 0; position < cases.size(); ++position)
      runs.push_back({cases, cases.at(position), first + cases.at(position)});
  }
  std::vector<Result> results(runs.size());
  for_each_job(runs.size(), jobs, [&](std::size_t position) {
    const auto& [cases, i, number] = runs[position];
    results[number] = run_scenario(checked(cases.load(i)),
                                   folder ? std::optional(RunOutput(folder(number), /*has_lock=*/true)) : std::nullopt,
                                   false, nullptr, Diagnose::nothing, {}, length);
    results[number].targets.clear();
  });
  return results;
}

}  // namespace hapbench
