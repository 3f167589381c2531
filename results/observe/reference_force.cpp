#include "results/observe/reference_force.hpp"

#include <algorithm>
#include <stdexcept>

namespace hapbench {

ReferenceForce::ReferenceForce(std::vector<Sample> samples) {
  if (samples.empty()) throw std::invalid_argument("a recorded force needs at least one sample");
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!(samples[i - 1].time < samples[i].time))
      throw std::invalid_argument("the times of a recorded force must increase strictly");
  }
  force_ = std::move(samples);
}

std::optional<Vec3> ReferenceForce::at(double t) const noexcept {
  if (const Ideal* ideal = std::get_if<Ideal>(&force_)) return Vec3((*ideal)[0](t), (*ideal)[1](t), (*ideal)[2](t));
  const std::vector<Sample>& samples = *std::get_if<std::vector<Sample>>(&force_);
  if (!(t >= samples.front().time && t <= samples.back().time)) return std::nullopt;
  const auto next = std::upper_bound(samples.begin(), samples.end(), t,
                                     [](double time, const Sample& sample) { return time < sample.time; });
  if (next == samples.end()) return samples.back().force;
  const Sample& from = *(next - 1);
  return from.force + (t - from.time) / (next->time - from.time) * (next->force - from.force);
}

}  // namespace hapbench
