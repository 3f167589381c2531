#pragma once

#include <optional>
#include <string>
#include <vector>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How far a scenario has the tool dragged in `duration` [s]: on and on along a direction, of points to the last [m].
double way_to_cover(const DragHandFields& hand, double duration);

/// For a path over the surface that falls short of `to_cover`, that way [m], by more than the tool's `width` [m], how
/// long it is and what to change; known before the run.
std::optional<std::string> short_path_warning(const DragHandFields& hand, double path, double to_cover, double width);

/// How far a dragged tool came on the path it was led along.
struct DragCourse {
  double to_cover = 0.0;      ///< way_to_cover up to the last row [m]
  double asked = 0.0;         ///< way of the point that leads it [m]
  double path = 0.0;          ///< length of the path [m]
  double way = 0.0;           ///< furthest place on the path that the tool came to [m]
  double still_since = 0.0;   ///< when it last came further by a spacing of the path [s]
  double asked_since = 0.0;   ///< way of the point since then [m]
  Vec3 place = Vec3::Zero();  ///< of the tip, in the last row [m]
  double height = 0.0;        ///< of the tip over the path where that is nearest, in the last row [m]
  double width = 0.0;         ///< the tool's [m]
  /// When the depth first reached the tool's half width: its axis is then in the surface.
  std::optional<double> through;
  /// Time of the last contact, if the tool was without for the default settling time up to the end although the hand
  /// pressed: after as long the next touch would be a landing.
  std::optional<double> lost;

  std::optional<std::string> short_path;  ///< short_path_warning

  /// The point has left it behind by more than the tool is wide. A tool that follows comes on as far as the point.
  bool stands_still() const { return asked_since > width; }
  /// It came nowhere, less than its width, although the way was longer than two: the spring that leads it lags by less.
  bool not_dragged() const { return way < width && to_cover > 2.0 * width; }
};

/// Follows a dragged tool; a few look-ups in the path's table, no allocation.
class DragCourseObserver final : public Observer {
 public:
  /// The hand and its fields must outlive the observer. `half_width`: the tool's [m].
  DragCourseObserver(const DragHand& hand, const DragHandFields& fields, double half_width);

  void on_step(const StepRecord& record) noexcept override;

  DragCourse course() const;

 private:
  const DragHand& hand_;
  const DragHandFields& fields_;
  double half_width_;
  double asked_at_way_ = 0.0;  ///< way of the point when the tool last came further
  double time_ = 0.0;          ///< of the last row
  std::optional<double> last_contact_;
  DragCourse course_;
};

/// What a reader of the results must know: that the tool stood still, has gone through the surface or has lost it.
std::vector<std::string> drag_warnings(const DragCourse& course);

}  // namespace hapbench
