#include "scenarios/analysis/stability/slow_bounces.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

void SlowBounces::add(const StepRecord& record, const JudgedRows& judged) noexcept {
  if (record.colliding == 0) {
    fly(record);
    return;
  }
  if (rows_away_ > 0) land(record.step, judged);
  touch(record);
}

void SlowBounces::touch(const StepRecord& record) noexcept {
  ++rows_touching_;
  rows_away_ = 0;
  last_contact_ = record.handle.position;
  if (record.force.rendered.squaredNorm() > 0.0) up_ = record.force.rendered.normalized();
}

void SlowBounces::fly(const StepRecord& record) noexcept {
  if (rows_away_++ == 0) height_ = 0.0;
  const double height = (record.handle.position - last_contact_).dot(up_);
  if (!(height > height_)) return;
  height_ = height;
  is_pressed_ = record.hand.measured.dot(up_) < 0.0;
}

void SlowBounces::land(std::uint64_t step, const JudgedRows& judged) noexcept {
  const std::uint64_t touching = std::exchange(rows_touching_, 0);
  const bool slow = static_cast<double>(touching + rows_away_) > longest_vibration_;
  if (!slow || touching >= rows_away_ || !is_pressed_ || !judged.contain(step)) return;
  const std::size_t half = 2 * (step - *judged.begin()) / (judged.end() - *judged.begin());
  ++counts_[half];
  highest_[half] = std::max(highest_[half], height_);
}

bool SlowBounces::go_on() const noexcept {
  constexpr int kLeast = 2;
  constexpr double kFallen = 0.99;
  return counts_[0] >= kLeast && counts_[1] >= kLeast && highest_[1] > kFallen * highest_[0];
}

}  // namespace hapbench
