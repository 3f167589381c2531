#include "scenarios/studies/stability/classify.hpp"

#include <algorithm>
#include <array>

namespace hapbench {
namespace {

constexpr double kGrowth = 1.01;
constexpr double kSustained = 0.01;
constexpr std::uint64_t kTurns = 2;
constexpr double kRest = 1e-12;

}  // namespace

std::string_view motion_class_name(MotionClass motion) noexcept {
  // In the order of the enumeration.
  constexpr std::array<std::string_view, 3> kNames = {"stable", "vibrating", "diverged"};
  return kNames[static_cast<std::size_t>(motion)];
}

void MotionClassifier::on_step(const StepRecord& record) noexcept {
  Quarter& quarter = quarters_[std::min<std::uint64_t>(3, record.step * 4 / steps_)];
  const Vec3& v = record.tool.velocity;
  const double speed = v.norm();
  quarter.amplitude = std::max(quarter.amplitude, speed);
  largest_speed_ = std::max(largest_speed_, speed);
  for (int i = 0; i < 3; ++i) quarter.turns[static_cast<std::size_t>(i)] += v[i] * last_velocity_[i] < 0.0;
  rows_at_rest_ = speed <= kRest * largest_speed_ ? rows_at_rest_ + 1 : 0;
  last_velocity_ = v;
}

bool MotionClassifier::oscillates_in(const Quarter& quarter) const noexcept {
  return std::any_of(quarter.turns.begin(), quarter.turns.end(), [](std::uint64_t n) { return n >= kTurns; });
}

MotionClass MotionClassifier::motion_class(Outcome outcome) const noexcept {
  if (outcome == Outcome::diverges) return MotionClass::diverged;
  const auto& q = quarters_;
  if (at_rest() || !oscillates_in(q[3])) return MotionClass::stable;
  bool grows = true;
  for (std::size_t i = 1; i < q.size(); ++i) grows = grows && q[i].amplitude > kGrowth * q[i - 1].amplitude;
  if (grows) return MotionClass::diverged;
  return q[3].amplitude >= kSustained * q[0].amplitude ? MotionClass::vibrating : MotionClass::stable;
}

MotionClass classify(Simulation& simulation, const MotionClassifier& classifier) noexcept {
  while (!classifier.at_rest() && simulation.step()) {
  }
  return classifier.motion_class(simulation.result().outcome);
}

}  // namespace hapbench
