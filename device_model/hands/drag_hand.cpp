#include "device_model/hands/drag_hand.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

DragHand::DragHand(Drag drag, std::shared_ptr<const SurfacePath> path)
    : drag_(std::move(drag)), path_(std::move(path)) {}

Vec3 DragHand::force(double t, const HandView& view) noexcept {
  const auto& [x, v] = view.handle;
  // Half of the way to the foot of the perpendicular on the path: in a few steps it is there, and it stays there on
  // paths that bend, where the whole way would overshoot.
  nearest_ += 0.5 * path_->direction(nearest_).dot(x - path_->at(nearest_).position);
  nearest_ = std::clamp(nearest_, 0.0, path_->length());
  const Vec3 n = path_->normal_near(x, nearest_);

  const double s = drag_.speed * t;
  Vec3 pull = drag_.stiffness * (path_->at(s).position - x) - drag_.damping * v;
  if (s < path_->length()) pull += drag_.damping * drag_.speed * path_->direction(s);
  return pull - n.dot(pull) * n - (drag_.force(t) + drag_.normal_damping * n.dot(v)) * n;
}

DragOrientation::DragOrientation(std::shared_ptr<const SurfacePath> path, double speed, double tilt, double azimuth)
    : path_(std::move(path)), speed_(speed), tilt_(tilt), azimuth_(azimuth) {}

Orientation DragOrientation::frame_at(double t) const noexcept {
  const double s = speed_ * t;
  return {path_->at(s).normal, path_->direction(s), {}, {}};
}

Vec3 DragOrientation::axis_at(double t) const noexcept {
  return tool_axis(frame_at(t), tilt_, azimuth_);
}

double DragOrientation::roll_at(double t) const noexcept {
  return tool_roll(frame_at(t), tilt_, azimuth_, 0.0);
}

}  // namespace hapbench
