#include "scenarios/analysis/stability/motion_classifier.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

// The amplitude of a quarter of the run is the largest speed in this quarter. kGrowth: a motion grows if the amplitude
// of each quarter is more than kGrowth times the amplitude of the quarter before. kLeft: a motion has decayed if the
// amplitude of the last quarter is less than kLeft times the amplitude of the first quarter. kSustained: a motion is
// decaying if the amplitudes of the third and of the last quarter are each less than kSustained times the amplitude of
// the quarter before. kRest: the tool is at rest if its speed is at most kRest times the largest speed of the run.
constexpr double kGrowth = 1.01, kLeft = 0.01, kSustained = 0.9, kRest = 1e-12;
constexpr double kFelt = 1e-3;  // smallest speed that a hand can feel [m/s]

}  // namespace

MotionClassifier MotionClassifier::of_moved_tool(std::uint64_t steps, double time_step, double still) {
  MotionClassifier classifier(steps);
  classifier.is_moved_ = true;
  classifier.high_pass_ = vibration_filter(time_step);
  if (still <= 0.5 * static_cast<double>(steps)) classifier.still_ = static_cast<std::uint64_t>(std::ceil(still));
  return classifier;
}

void MotionClassifier::on_step(const StepRecord& record) noexcept {
  const Vec3& velocity = record.body_velocity();
  if (high_pass_ && record.step == 0) high_pass_->settle_at(velocity);
  const Vec3 v = high_pass_ ? high_pass_->filter(velocity) : velocity;
  all_.add(record.step * 4 / steps_, v);
  if (still_ && record.step >= *still_) held_.add((record.step - *still_) * 4 / (steps_ - *still_), velocity);
  const double speed = v.norm();
  largest_speed_ = std::max(largest_speed_, speed);
  rows_at_rest_ = speed <= kRest * largest_speed_ ? rows_at_rest_ + 1 : 0;
}

bool MotionClassifier::is_undecided() const noexcept {
  const Quarter &first = all_.quarters.front(), &last = all_.quarters.back();
  if (is_moved_ || at_rest() || last.oscillates()) return false;
  return last.amplitude >= kLeft * first.amplitude && last.amplitude > 0.0;
}

MotionClass MotionClassifier::motion_class(Ending ending) const noexcept {
  if (ending == Ending::diverged) return MotionClass::diverged;
  if (at_rest()) return MotionClass::stable;
  // After the script ends, a hand may swing with a growing amplitude for a while. This slow motion counts as vibrating
  // at most, not as diverged.
  return std::max(all_.motion_class(is_moved_ ? kFelt : 0.0),
                  std::min(held_.motion_class(kFelt), MotionClass::vibrating));
}

bool MotionClassifier::Quarter::oscillates() const noexcept {
  return std::ranges::max(turns) >= 2;
}

void MotionClassifier::Interval::add(std::uint64_t quarter, const Vec3& velocity) noexcept {
  Quarter& here = quarters[std::min<std::uint64_t>(3, quarter)];
  here.amplitude = std::max(here.amplitude, velocity.norm());
  for (int i = 0; i < 3; ++i) {
    if (velocity[i] == 0.0) continue;
    here.turns[static_cast<std::size_t>(i)] += velocity[i] * last_velocity[i] < 0.0;
    last_velocity[i] = velocity[i];
  }
}

MotionClass MotionClassifier::Interval::motion_class(double felt) const noexcept {
  const auto& q = quarters;
  if (!q[3].oscillates() || q[3].amplitude < felt) return MotionClass::stable;
  if (grows()) return MotionClass::diverged;
  if (q[3].amplitude < kLeft * q[0].amplitude) return MotionClass::stable;
  const bool decays = q[2].amplitude < kSustained * q[1].amplitude && q[3].amplitude < kSustained * q[2].amplitude;
  return decays ? MotionClass::dying_out : MotionClass::vibrating;
}

bool MotionClassifier::Interval::fades() const noexcept {
  for (std::size_t i = 1; i < quarters.size(); ++i)
    if (!(kGrowth * quarters[i].amplitude < quarters[i - 1].amplitude)) return false;
  return true;
}

bool MotionClassifier::Interval::grows() const noexcept {
  for (std::size_t i = 1; i < quarters.size(); ++i)
    if (!(quarters[i].amplitude > kGrowth * quarters[i - 1].amplitude)) return false;
  return true;
}

}  // namespace hapbench
