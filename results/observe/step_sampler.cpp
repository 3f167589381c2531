#include "results/observe/step_sampler.hpp"

namespace hapbench {

StepSampler::StepSampler(std::uint64_t steps)
    : every_(steps / kMostSamples + 1), times_(static_cast<std::size_t>(steps / every_) + 1) {}

void StepSampler::start(std::uint64_t step) noexcept {
  if (step % every_ != 0) return;
  runs_ = true;
  times_.start();
}

void StepSampler::stop() noexcept {
  if (!runs_) return;
  runs_ = false;
  times_.lap();
}

}  // namespace hapbench
