#include "scenarios/run/approach.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenarios/run/scene_distances.hpp"

namespace hapbench {

Approach::Approach(std::shared_ptr<const PointShell> shell, std::uint64_t steps)
    : shell_(std::move(shell)), environment_(shell_->bounds()), interval_(steps / kMaxCandidates + 1) {
  candidates_.reserve(kMaxCandidates);
}

void Approach::add(const StepRecord& record, bool before_contact) noexcept {
  const Vec3& position = record.tool.pose.position;
  const double step_length = (position - position_).norm();
  // If the step is at least as long as the distance from the bounding box at the start of the step (distance_), the tip
  // may have reached the surface in this step.
  if (distance_ <= step_length && std::isfinite(step_length)) longest_step_ = std::max(longest_step_, step_length);
  position_ = position;
  time_ = record.time;
  distance_ = distance_to(environment_, position);
  // Before the first contact, keep the step closest to the bounding box in each interval of the run.
  if (!before_contact) return;
  const Candidate candidate{record.time, distance_, record.tool.pose};
  if (record.step % interval_ == 0) {
    candidates_.push_back(candidate);
  } else if (candidate.from_box <= candidates_.back().from_box) {
    candidates_.back() = candidate;
  }
}

Approach::Closest Approach::closest_to_surface(const ToolShape& tool) const {
  constexpr double kRelativeAccuracy = 0.99;
  Closest closest{std::numeric_limits<double>::infinity(), 0.0};
  std::vector<double> lower_bounds(candidates_.size(), 0.0);
  // Search the candidate with the smallest lower bound, until no lower bound is below the smallest distance
  // found.
  for (;;) {
    const auto next = std::ranges::min_element(lower_bounds);
    if (next == lower_bounds.end() || *next >= kRelativeAccuracy * closest.distance) break;
    const Candidate& candidate = candidates_[static_cast<std::size_t>(next - lower_bounds.begin())];
    const auto [gap, touching, is_estimate] = gap_between(tool, candidate.pose, *shell_);
    if (gap < closest.distance) closest = {gap, candidate.time, {}, is_estimate};
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      lower_bounds[i] = std::max(lower_bounds[i], gap - tool.displacement_bound(candidate.pose, candidates_[i].pose));
    // Exclude this candidate from further searches.
    *next = std::numeric_limits<double>::infinity();
  }
  // If the tool was closest in the last step, extrapolate its approach to the surface.
  if (closest.time != time_ || candidates_.size() < 2) return closest;
  const Candidate& before = *(candidates_.end() - 2);
  const double approached = gap_between(tool, before.pose, *shell_).distance - closest.distance;
  if (approached > 0.0) closest.time_to_contact = closest.distance / approached * (time_ - before.time);
  return closest;
}

}  // namespace hapbench
