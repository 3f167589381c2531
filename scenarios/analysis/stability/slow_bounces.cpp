#include "scenarios/analysis/stability/slow_bounces.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

void SlowBounces::add(const StepRecord& record, const EvaluationWindow& judged) noexcept {
  if (record.colliding == 0) {
    leave(record);
    return;
  }
  if (steps_away_ > 0) land(record.step, judged);
  touch(record);
}

void SlowBounces::touch(const StepRecord& record) noexcept {
  ++steps_in_contact_;
  steps_away_ = 0;
  last_contact_ = record.handle.position;
  if (record.force.rendered.squaredNorm() > 0.0) up_ = record.force.rendered.normalized();
}

void SlowBounces::leave(const StepRecord& record) noexcept {
  if (steps_away_++ == 0) height_ = 0.0;
  const double height = (record.handle.position - last_contact_).dot(up_);
  if (!(height > height_)) return;
  height_ = height;
  is_pressed_ = record.hand.measured.dot(up_) < 0.0;
}

void SlowBounces::land(std::uint64_t step, const EvaluationWindow& judged) noexcept {
  const std::uint64_t in_contact = std::exchange(steps_in_contact_, 0);
  // Count the bounce only if it is slow, if the tool was out of contact for longer than the preceding contact lasted,
  // and if the hand pressed the tool towards the surface.
  const bool slow = static_cast<double>(in_contact + steps_away_) > longest_vibration_;
  if (!slow || in_contact >= steps_away_ || !is_pressed_ || !judged.contain(step)) return;
  const std::size_t half = 2 * (step - *judged.begin()) / (judged.end() - *judged.begin());
  ++counts_[half];
  highest_[half] = std::max(highest_[half], height_);
}

bool SlowBounces::persist() const noexcept {
  constexpr int kMinBounces = 2;
  // Smallest ratio of two heights: highest bounce of the second half, divided by highest bounce of the first half.
  constexpr double kLowered = 0.99;
  return counts_[0] >= kMinBounces && counts_[1] >= kMinBounces && highest_[1] > kLowered * highest_[0];
}

}  // namespace hapbench
