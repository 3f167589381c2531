#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include "sim/contact/inside.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Distance from the tip centre back to the place half the tool's width within the body [m]; of a ball 0.
double way_to_core(const ToolShape& tool);
inline constexpr double kMostStepsOfWay = 256.0;  ///< in which the way of a row is followed through a solid

/// True for the normals of faces that look away from each other, by more than the rounding of a right angle.
inline bool look_away(const Vec3& a, const Vec3& b) noexcept {
  return a.dot(b) < -1e-3;
}

/// Finds a tool that goes through a wall, also one thinner than the tool: by its core, the part of its axis that is in
/// its body, from the tip centre to the far end. The core has gone through when it crosses the solid from face to face
/// at one time, the faces looking away from each other, or when a part of it comes out by a face that looks away from
/// the one by which it had entered.
///
/// A row costs a look only while a contact is so deep that the core is close to the surface (looks_from_), or when the
/// tool moves by a large part of its width in it; and then only once the core has moved by its distance from the
/// surface. A look is some 20 distances, along the axis. None follows the first passage. Allocates when constructed.
class CorePassage {
 public:
  struct Event {
    double time;         ///< [s]
    Vec3 entered, left;  ///< [m]
    bool at_once;        ///< from face to face
  };

  CorePassage(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid);

  /// A row: its deepest contact, and how far the tip centre or a place near it moved [m].
  void add(const ToolPose& pose, double deepest_contact, double moved, double time) noexcept {
    if (event_) return;
    if (deepest_contact >= looks_from_ || moved > looks_from_way_) {
      look(pose, deepest_contact, time);
    } else {
      free_way_ = 0.0;
      follows_ = false;
    }
    position_ = pose.position;
    axis_ = pose.axis;
    began_ = true;
  }

  const std::optional<Event>& event() const noexcept { return event_; }

 private:
  /// A stretch of the core that is inside, from `low` to `high` on the axis [m].
  struct Stretch {
    double low, high;
    std::optional<Vec3> face_low, face_high;  ///< outward normals where it ends at the surface
    double deepest;                           ///< phi, the least [m]
    Vec3 deepest_place;
    /// The face by which it entered, where, and the part that did.
    Vec3 normal = Vec3::Zero(), entered = Vec3::Zero();
    double own_low = 0.0, own_high = 0.0;
  };
  struct Stretches {
    std::array<Stretch, 8> of;
    std::size_t count = 0;
  };

  void look(const ToolPose& pose, double deepest_contact, double time) noexcept;
  double look_at(const Vec3& position, const Vec3& axis, double front, double time) noexcept;
  double find_inside(const Vec3& position, const Vec3& axis, double front, Stretches& found) const noexcept;
  void compare(const Vec3& position, const Vec3& axis, Stretches& now, double time) noexcept;
  Vec3 normal_at(const Vec3& place) const noexcept;

  std::shared_ptr<const ToolShape> tool_;
  std::shared_ptr<const Solid> solid_;
  double width_;                        ///< half the tool's [m]
  double far_;                          ///< the core's far end on the axis [m]
  double shallow_;                      ///< where it begins while no contact is deep [m]
  double looks_from_, looks_from_way_;  ///< depth of a contact, and way in a row [m]

  Vec3 position_ = Vec3::Zero(), axis_ = Vec3::Zero();  ///< in the row before
  bool began_ = false, follows_ = false;                ///< there was a row before; it was also looked at
  double free_way_ = 0.0;                               ///< of the core, on which nothing changes [m]
  Stretches inside_;
  std::optional<Event> event_;
};

}  // namespace hapbench
