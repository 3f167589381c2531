#include "results/record/trajectory_recorder.hpp"

#include <cassert>
#include <optional>
#include <utility>

namespace hapbench {

TrajectoryRecorder::TrajectoryRecorder(std::filesystem::path file, std::uint64_t every)
    : csv_(std::move(file), kColumns), every_(every) {
  assert(every > 0);
}

void TrajectoryRecorder::on_step(const StepRecord& r) noexcept {
  if (!is_recorded(r, every_)) return;
  const bool has_ratio = !r.rendered->empty();
  const auto ratio_min = has_ratio ? std::optional(r.ratio.min) : std::nullopt;
  const auto ratio_max = has_ratio ? std::optional(r.ratio.max) : std::nullopt;
  csv_.row(r.step, r.time, r.tool.pose.position, r.tool.velocity, r.tool.pose.axis, r.force.rendered, r.force.spring,
           r.hand.measured, r.hand.input, r.handle.position, r.colliding, r.rendered->size(), r.force.depth_max,
           ratio_min, ratio_max);
}

}  // namespace hapbench
