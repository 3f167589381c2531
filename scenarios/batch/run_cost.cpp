#include "scenarios/batch/run_cost.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "scenarios/run/bare_run.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

/// Intended minimum processor time of a measurement [s]. The clock has a resolution of about a microsecond.
constexpr double kMinMeasured = 0.02;
constexpr double kMaxTimes = 1000.0;

/// A scenario that is measured in rounds.
struct Measured {
  std::unique_ptr<BareRun> run;
  std::uint64_t times = 1;           ///< number of runs in one measurement
  std::vector<double> seconds = {};  ///< time of one run [s], for each round
};

}  // namespace

bool is_faster(const RunCost& a, const RunCost& b) {
  return b.step_s - a.step_s > a.spread_s + b.spread_s;
}

std::vector<RunCost> measure_cost(std::size_t count, const std::function<CheckedScenario(std::size_t)>& scene,
                                  const JobOptions& jobs, unsigned repetitions) {
  std::vector<RunCost> costs(count);
  std::vector<Measured> all(count);
  JobOptions one_by_one = jobs;
  one_by_one.threads = 1;
  // The first round warms the caches, and determines how often a short run is repeated.
  for_each_job(count * (repetitions + 1), one_by_one, [&](std::size_t job) {
    const std::size_t i = job % count;
    Measured& measured = all[i];
    if (job < count) {
      const CheckedScenario checked = scene(i);
      costs[i].time_step_s = checked.scenario().time.step;
      measured.run = std::make_unique<BareRun>(checked, make_shell(checked.scenario(), checked.files()));
      const double seconds = std::max(measured.run->seconds(1), 1e-9);
      measured.times = static_cast<std::uint64_t>(std::clamp(std::ceil(kMinMeasured / seconds), 1.0, kMaxTimes));
      return;
    }
    measured.seconds.push_back(measured.run->seconds(measured.times));
  });
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double>& seconds = all[i].seconds;
    std::ranges::sort(seconds);
    costs[i].steps = all[i].run->steps();
    const auto steps = static_cast<double>(std::max<std::uint64_t>(costs[i].steps, 1));
    costs[i].step_s = seconds.front() / steps;
    costs[i].spread_s = (seconds[seconds.size() / 2] - seconds.front()) / steps;
  }
  return costs;
}

}  // namespace hapbench
