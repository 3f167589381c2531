#include "results/observe/ideal_trajectory.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "results/observe/interpenetration.hpp"

namespace hapbench {

std::optional<TipPlace> ideal_place(const BlockWithHole& block, double tool_radius, double tilt) {
  if (!(tilt > 0.0 && tilt < std::numbers::pi / 2)) return std::nullopt;
  const double R = block.hole_diameter / 2, r = tool_radius;
  const double cosine = std::cos(tilt), sine = std::sin(tilt);
  const TipPlace place{-R + r * cosine, (r * (1.0 + cosine * cosine) - 2.0 * R * cosine) / sine};
  const bool edge_in_hole = place.height + r * sine<0.0, above_bottom = place.height - r * sine> - block.hole_depth;
  if (!edge_in_hole || !above_bottom) return std::nullopt;
  return place;
}

IdealTrajectoryObserver::IdealTrajectoryObserver(const BlockWithHole& block, const Cylinder& tool, std::uint64_t every)
    : block_(block), tool_(tool), every_(every) {
  assert(every > 0);
}

void IdealTrajectoryObserver::on_step(const StepRecord& record) noexcept {
  error_.reset();
  if (record.step % every_ != 0) return;
  const ToolPose& pose = record.tool.pose;
  const Vec3 lean{-pose.axis.x(), -pose.axis.y(), 0.0};
  const double sine = lean.norm(), tilt = std::atan2(sine, -pose.axis.z());
  const auto ideal = ideal_place(block_, tool_.radius(), tilt);
  if (!ideal) {
    ++sums_.rows_without_ideal;
    return;
  }
  TrajectoryError& error = error_.emplace();
  error.tilt = tilt;
  error.actual = {pose.position.dot(lean) / sine, pose.position.z()};
  error.ideal = *ideal;
  error.interpenetration = interpenetration(block_, tool_, pose);
  error.hand_force = record.hand_force.norm();
  add(error.hand_force < kGentleForce ? sums_.gentle : sums_.firm, error);
}

void IdealTrajectoryObserver::add(TrajectoryErrors& sums, const TrajectoryError& error) noexcept {
  const double height = error.actual.height - error.ideal.height;
  const double lateral = error.actual.lateral - error.ideal.lateral;
  sums.height_min = sums.rows == 0 ? height : std::min(sums.height_min, height);
  sums.height_max = sums.rows == 0 ? height : std::max(sums.height_max, height);
  sums.height_mean += height;
  sums.height_rms += height * height;
  sums.lateral_mean += lateral;
  sums.lateral_rms += lateral * lateral;
  sums.lateral_max_abs = std::max(sums.lateral_max_abs, std::abs(lateral));
  sums.interpenetration_mean += error.interpenetration;
  sums.interpenetration_max = std::max(sums.interpenetration_max, error.interpenetration);
  ++sums.rows;
}

IdealTrajectoryMetrics IdealTrajectoryObserver::metrics() const noexcept {
  IdealTrajectoryMetrics metrics = sums_;
  for (TrajectoryErrors* errors : {&metrics.gentle, &metrics.firm}) {
    if (errors->rows == 0) continue;
    const auto rows = static_cast<double>(errors->rows);
    errors->height_mean /= rows;
    errors->height_rms = std::sqrt(errors->height_rms / rows);
    errors->lateral_mean /= rows;
    errors->lateral_rms = std::sqrt(errors->lateral_rms / rows);
    errors->interpenetration_mean /= rows;
  }
  return metrics;
}

}  // namespace hapbench
