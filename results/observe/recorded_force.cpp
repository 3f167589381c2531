#include "results/observe/recorded_force.hpp"

#include <algorithm>
#include <stdexcept>

namespace hapbench {

RecordedForce::RecordedForce(std::vector<Sample> samples) : samples_(std::move(samples)) {
  if (samples_.empty()) throw std::invalid_argument("a recorded force needs at least one sample");
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    if (!(samples_[i - 1].time < samples_[i].time))
      throw std::invalid_argument("the times of a recorded force must increase strictly");
  }
}

std::optional<Vec3> RecordedForce::at(double t) const noexcept {
  if (!(t >= samples_.front().time && t <= samples_.back().time)) return std::nullopt;
  const auto next = std::upper_bound(samples_.begin(), samples_.end(), t,
                                     [](double time, const Sample& sample) { return time < sample.time; });
  if (next == samples_.end()) return samples_.back().force;
  const Sample& from = *(next - 1);
  return from.force + (t - from.time) / (next->time - from.time) * (next->force - from.force);
}

}  // namespace hapbench
