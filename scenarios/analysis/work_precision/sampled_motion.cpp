#include "scenarios/analysis/work_precision/sampled_motion.hpp"

#include <cmath>
#include <utility>

#include "scenarios/run/assemble.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

/// Stores the tip position and the rendered force in every n-th step.
class MotionSampler final : public Observer {
 public:
  MotionSampler(std::uint64_t steps, std::uint64_t every) : every_(every) {
    motion_.position.reserve(steps / every + 1);
    motion_.force.reserve(steps / every + 1);
  }

  void on_step(const StepRecord& record) noexcept override {
    if (record.step % every_ != 0) return;
    motion_.position.push_back(record.tool.pose.position);
    motion_.force.push_back(record.force.rendered);
  }

  SampledMotion& motion() { return motion_; }

 private:
  std::uint64_t every_;
  SampledMotion motion_;
};

/// Returns the root mean square of the distances |a[i] - b[i]|.
double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

SampledMotion sampled_motion(const CheckedScenario& checked, const Vec3& shift) {
  const Scenario& scenario = checked.scenario();
  SimulationConfig config = simulation_config(scenario);
  config.position += shift;
  MotionSampler sampler(config.steps, static_cast<std::uint64_t>(scenario.time.stride));
  SimulationParts parts = assemble(scenario, checked.files(), make_shell(scenario, checked.files()), Trial{});
  const auto outcome = outcome_observer(scenario, checked.files(), parts);
  Simulation simulation(config, std::move(parts), {&sampler, outcome.get()});
  sampler.motion().ending = run_to_end(simulation).ending;
  sampler.motion().outcome = outcome->outcome(sampler.motion().ending);
  return std::move(sampler.motion());
}

std::optional<MotionDifference> difference(const SampledMotion& a, const SampledMotion& b) {
  if (a.position.empty() || a.position.size() != b.position.size() || a.ending != b.ending) return std::nullopt;
  return MotionDifference{rms_distance(a.position, b.position), rms_distance(a.force, b.force)};
}

}  // namespace hapbench
