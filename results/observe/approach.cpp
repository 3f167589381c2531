#include "results/observe/approach.hpp"

namespace hapbench {

void ApproachObserver::on_step(const StepRecord& record) noexcept {
  approach_.last = distance_to(environment_, record.tool.pose.position);
  if (approach_.last >= approach_.closest) return;
  approach_.closest = approach_.last;
  approach_.closest_time = record.time;
}

}  // namespace hapbench
