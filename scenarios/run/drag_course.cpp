#include "scenarios/run/drag_course.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/observe/contact_forces.hpp"
#include "scenarios/run/quantity_text.hpp"

namespace hapbench {

double way_to_cover(const DragHandFields& hand, double duration) {
  const double way = hand.drag.speed * duration;
  if (!hand.path) return way;
  double legs = 0.0;
  for (std::size_t i = 1; i < hand.path->size(); ++i) legs += ((*hand.path)[i] - (*hand.path)[i - 1]).norm();
  return std::min(way, legs);
}

std::optional<std::string> short_path_warning(const DragHandFields& hand, double path, double to_cover, double width) {
  // By less than the tool is wide it is the edge that ends the way.
  if (to_cover <= path + width) return std::nullopt;
  const std::string ends =
      fmt::format("the path of the drag ends after {} of {}: ", length_text(path), length_text(to_cover));
  return ends + (hand.path ? "hand.path_m leads no further over the surface; let its points lie on it"
                           : "beyond, the surface ends or turns against hand.direction; another initial.position_m, a "
                             "larger hand.smoothing_m or hand.path_m leads further");
}

DragCourseObserver::DragCourseObserver(const DragHand& hand, const DragHandFields& fields, double half_width)
    : hand_(hand), fields_(fields), half_width_(half_width) {
  course_.width = 2.0 * half_width;
}

void DragCourseObserver::on_step(const StepRecord& record) noexcept {
  const SurfacePath& path = hand_.path();
  DragCourse& c = course_;
  time_ = record.time;
  c.asked = std::min(hand_.drag().speed * record.time, path.length());
  if (hand_.nearest() >= c.way + path.spacing()) {
    c.way = hand_.nearest();
    c.still_since = record.time;
    asked_at_way_ = c.asked;
  }
  c.place = record.tool.pose.position;
  if (!c.through && record.force.depth_max >= half_width_) c.through = record.time;
  if (record.colliding > 0) last_contact_ = record.time;
}

DragCourse DragCourseObserver::course() const {
  DragCourse course = course_;
  course.asked_since = course.asked - asked_at_way_;
  const SurfacePoint foot = hand_.path().at(hand_.nearest());
  course.height = foot.normal.dot(course.place - foot.position);
  course.path = hand_.path().length();
  course.to_cover = way_to_cover(fields_, time_);
  course.short_path = short_path_warning(fields_, course.path, course.to_cover, course.width);
  const bool presses = hand_.drag().force(time_) > 0.0;
  if (presses && last_contact_ && time_ - *last_contact_ >= SettlingRule().time) course.lost = last_contact_;
  return course;
}

std::vector<std::string> drag_warnings(const DragCourse& c) {
  std::vector<std::string> warnings;
  if (c.through)
    warnings.push_back(
        fmt::format("the dragged tool has gone through the surface at {:.4g} s: the depth reached its half width, {}",
                    *c.through, length_text(0.5 * c.width)));
  if (c.lost) {
    const std::string where = c.height < 0.0 ? "below it: it went through, or past an edge" : "above it";
    warnings.push_back(fmt::format("the dragged tool lost the surface at {:.4g} s and ended {} {}", *c.lost,
                                   length_text(std::abs(c.height)), where));
  } else if (c.stands_still()) {
    warnings.push_back(
        fmt::format("the dragged tool stood still since {:.4g} s, {} along the path of {} asked, at [{:.4g}, {:.4g}, "
                    "{:.4g}] m in the end",
                    c.still_since, length_text(c.way), length_text(c.asked), c.place.x(), c.place.y(), c.place.z()));
  }
  if (c.short_path) {
    warnings.push_back(fmt::format("{}; the tool was at [{:.4g}, {:.4g}, {:.4g}] m in the end", *c.short_path,
                                   c.place.x(), c.place.y(), c.place.z()));
  }
  return warnings;
}

}  // namespace hapbench
