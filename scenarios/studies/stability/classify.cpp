#include "scenarios/studies/stability/classify.hpp"

#include <algorithm>
#include <array>

#include "results/observe/metrics.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

constexpr double kGrowth = 1.01;
constexpr double kLeft = 0.01;
constexpr double kSustained = 0.9;
constexpr std::uint64_t kTurns = 2;
constexpr double kRest = 1e-12;
constexpr double kFelt = 1e-3;  // [m/s]

}  // namespace

const MotionClassText& text_of(MotionClass motion) noexcept {
  // In the order of the enumeration.
  static constexpr MotionClassText kTexts[] = {
      {"stable", "at rest, died out or creeping", "all else: at rest, died out, creeping"},
      {"dying_out", "still oscillates, but comes to rest if the run goes on",
       "oscillates as much, but loses a tenth of its amplitude from the second quarter to the third and again to the "
       "last"},
      {"vibrating", "oscillates and does not decay",
       "does not decay: oscillates in the last quarter with at least 1 % of the first quarter's amplitude"},
      {"diverged", "left its bounds, or oscillates with a growing amplitude",
       "left its bounds, or oscillates with an amplitude that grows by 1 % from each quarter to the next"}};
  return kTexts[static_cast<std::size_t>(motion)];
}

MotionClassifier MotionClassifier::of_moved_tool(std::uint64_t steps, double time_step) {
  MotionClassifier classifier(steps);
  classifier.is_moved_ = true;
  classifier.high_pass_ = vibration_filter(time_step);
  return classifier;
}

void MotionClassifier::on_step(const StepRecord& record) noexcept {
  Quarter& quarter = quarters_[std::min<std::uint64_t>(3, record.step * 4 / steps_)];
  if (high_pass_ && record.step == 0) high_pass_->settle_at(record.body_velocity());
  const Vec3 v = high_pass_ ? high_pass_->filter(record.body_velocity()) : record.body_velocity();
  const double speed = v.norm();
  quarter.amplitude = std::max(quarter.amplitude, speed);
  largest_speed_ = std::max(largest_speed_, speed);
  for (int i = 0; i < 3; ++i) {
    if (v[i] == 0.0) continue;
    quarter.turns[static_cast<std::size_t>(i)] += v[i] * last_velocity_[i] < 0.0;
    last_velocity_[i] = v[i];
  }
  rows_at_rest_ = speed <= kRest * largest_speed_ ? rows_at_rest_ + 1 : 0;
}

bool MotionClassifier::oscillates_in(const Quarter& quarter) const noexcept {
  return std::any_of(quarter.turns.begin(), quarter.turns.end(), [](std::uint64_t n) { return n >= kTurns; });
}

MotionClass MotionClassifier::motion_class(Outcome outcome) const noexcept {
  if (outcome == Outcome::diverges) return MotionClass::diverged;
  const auto& q = quarters_;
  if (at_rest() || !oscillates_in(q[3])) return MotionClass::stable;
  if (is_moved_ && q[3].amplitude < kFelt) return MotionClass::stable;
  bool grows = true;
  for (std::size_t i = 1; i < q.size(); ++i) grows = grows && q[i].amplitude > kGrowth * q[i - 1].amplitude;
  if (grows) return MotionClass::diverged;
  if (q[3].amplitude < kLeft * q[0].amplitude) return MotionClass::stable;
  const bool decays = q[2].amplitude < kSustained * q[1].amplitude && q[3].amplitude < kSustained * q[2].amplitude;
  return decays ? MotionClass::dying_out : MotionClass::vibrating;
}

MotionClass classify(Simulation& simulation, const MotionClassifier& classifier) {
  for (bool more = true; more;) {
    throw_if_stopped();
    for (std::uint64_t i = 0; i < kAskEvery && more; ++i) more = !classifier.at_rest() && simulation.step();
  }
  throw_if_stopped();
  return classifier.motion_class(simulation.result().outcome);
}

}  // namespace hapbench
