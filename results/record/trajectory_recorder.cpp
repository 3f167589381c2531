#include "results/record/trajectory_recorder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <utility>

namespace hapbench {
namespace {

template <std::size_t n, std::size_t m>
constexpr std::array<Column, n + m> joined(const Column (&first)[n], const Column (&second)[m]) {
  std::array<Column, n + m> all{};
  std::copy_n(second, m, std::copy_n(first, n, all.begin()));
  return all;
}

/// w, x, y, z; of the two that mean the same rotation the one with w >= 0.
std::array<double, 4> quaternion(const Mat3& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
}

}  // namespace

std::span<const Column> TrajectoryRecorder::columns(const TrajectoryExtras& extras) {
  static constexpr auto kExtras = joined(kPoseColumns, kTorqueColumns);
  static constexpr auto kWithTorque = joined(kColumns, kTorqueColumns);
  static constexpr auto kWithAll = [] {
    std::array<Column, std::size(kColumns) + kExtras.size()> all{};
    std::copy(kExtras.begin(), kExtras.end(), std::copy_n(kColumns, std::size(kColumns), all.begin()));
    return all;
  }();
  if (extras.torque && !extras.pose) return kWithTorque;
  const std::size_t extra = extras.torque ? kExtras.size() : extras.pose ? std::size(kPoseColumns) : 0;
  return std::span(kWithAll).first(std::size(kColumns) + extra);
}

TrajectoryRecorder::TrajectoryRecorder(TableTarget target, std::uint64_t every, const TrajectoryExtras& extras)
    : writer_(std::move(target), columns(extras)), every_(every), extras_(extras) {
  assert(every > 0);
}

void TrajectoryRecorder::on_step(const StepRecord& r) noexcept {
  if (!is_recorded(r, every_)) return;
  const bool has_ratio = !r.rendered->empty();
  const auto ratio_min = has_ratio ? std::optional(r.ratio.min) : std::nullopt;
  const auto ratio_max = has_ratio ? std::optional(r.ratio.max) : std::nullopt;
  std::array<double, 7> extras;
  std::size_t count = 0;
  const auto add = [&](const auto& values) {
    for (const double value : values) extras[count++] = value;
  };
  if (extras_.pose) add(quaternion(ToolPose{r.tool.pose.position, r.tool.pose.axis, r.roll}.rotation()));
  if (extras_.torque) add(r.springs.moment);
  writer_.row(r.step, r.time, r.tool.pose.position, r.tool.velocity, r.tool.pose.axis, r.force.rendered, r.force.spring,
              r.hand.measured, r.hand.input, r.handle.position, r.colliding, r.rendered->size(), r.force.depth_max,
              ratio_min, ratio_max, std::span<const double>(extras.data(), count));
}

}  // namespace hapbench
