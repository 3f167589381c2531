#include "results/observe/core_passage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace hapbench {
namespace {

/// Relative to the half width: the depth of a contact from which on the tip centre itself is part of the core, as a
/// flat tip's is in the surface at any depth; the least step along the core and of its way.
constexpr double kDeep = 0.9, kCoreStep = 5e-3;
/// Relative to where the tool is thinnest, as at a neck: the depth of a contact from which on the core is looked at. A
/// little less than kDeep, because points of a surface, which are some fifths of that apart, may miss the core.
constexpr double kLookFrom = 0.8;
/// The core ends where the axis comes so close to the body's surface, in half widths, as in a bent body.
constexpr double kThinnest = 0.05;
constexpr std::size_t kCoreSamples = 256;  ///< of the tool's thickness

}  // namespace

double way_to_core(const ToolShape& tool) {
  ContactBuffer tip(1);
  tip.push(0, Vec3::Zero(), Vec3::UnitZ());
  tool.surface_constraints(ToolPose{}, Vec3::Zero(), 0.0, tip);
  return std::clamp(tool.half_width() - tip.depth[0], 0.0, tool.half_width());
}

CorePassage::CorePassage(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid)
    : tool_(std::move(tool)), solid_(std::move(solid)), width_(tool_->half_width()) {
  const double back = way_to_core(*tool_);
  shallow_ = -kDeep * back;
  far_ = 0.0;
  for (const ProfilePoint& p : tool_->outline()) far_ = std::min(far_, p.s);
  const ToolPose pose;
  ContactBuffer axis(kCoreSamples);
  const auto place = [this](std::size_t i) { return far_ * static_cast<double>(i) / (kCoreSamples - 1); };
  for (std::size_t i = 0; i < kCoreSamples; ++i) axis.push(0, place(i) * pose.axis, Vec3::UnitZ());
  tool_->surface_constraints(pose, Vec3::Zero(), 0.0, axis);
  double thinnest = width_;
  const double end = far_ + width_;  // behind it, the far end is nearest
  for (std::size_t i = 0; i < kCoreSamples; ++i) {
    const double s = place(i);
    if (s > -back || s < end) continue;
    if (axis.depth[i] < kThinnest * width_) {
      far_ = s;
      break;
    }
    thinnest = std::min(thinnest, axis.depth[i]);
  }
  looks_from_ = kLookFrom * thinnest;
  looks_from_way_ = (1.0 - kDeep) * thinnest;
}

Vec3 CorePassage::normal_at(const Vec3& place) const noexcept {
  return solid_->gradient(place, kNormalsOver * width_);
}

/// Follows the core from the row before in steps on which it cannot meet the surface.
void CorePassage::look(const ToolPose& pose, double deepest_contact, double time) noexcept {
  const Vec3 moved = began_ ? Vec3(pose.position - position_) : Vec3::Zero();
  const Vec3 turned = began_ ? Vec3(pose.axis - axis_) : Vec3::Zero();
  const double way = moved.norm() - far_ * turned.norm();
  if (!std::isfinite(way)) return;
  if (free_way_ > way) {
    free_way_ -= way;
    return;
  }
  const double front = deepest_contact >= kDeep * width_ ? 0.0 : shallow_;
  const double least = std::max(kCoreStep * width_, way / kMostStepsOfWay);
  double done = std::min(free_way_, way);
  for (;;) {
    const double rest = way > 0.0 ? 1.0 - done / way : 0.0;
    const double clear = look_at(pose.position - rest * moved, (pose.axis - rest * turned).normalized(), front, time);
    if (event_ || done >= way) {
      free_way_ = std::max(clear, kCoreStep * width_);
      return;
    }
    done = std::min(way, done + std::max(clear, least));
  }
}

/// Returns a way on which the core cannot meet the surface [m].
double CorePassage::look_at(const Vec3& position, const Vec3& axis, double front, double time) noexcept {
  Stretches now;
  const double clear = find_inside(position, axis, front, now);
  compare(position, axis, now, time);
  inside_ = now;
  follows_ = true;
  return clear;
}

double CorePassage::find_inside(const Vec3& position, const Vec3& axis, double front, Stretches& found) const noexcept {
  enum class Side { unknown, outside, inside };
  Side before = Side::unknown;
  double s = front, nearest = std::numeric_limits<double>::infinity();
  Vec3 last = position + s * axis;
  for (;;) {
    const Vec3 place = position + s * axis;
    const SurfaceDistance phi = solid_->at(place);
    const Side side = !phi.known ? Side::unknown : phi.value < 0.0 ? Side::inside : Side::outside;
    nearest = std::min(nearest, std::abs(phi.value));
    if (side == Side::inside) {
      if (before != Side::inside) {
        if (found.count == found.of.size()) break;
        Stretch& next = found.of[found.count++];
        next = {s, s, {}, {}, phi.value, place};
        if (before == Side::outside) next.face_high = normal_at(last);
      }
      Stretch& stretch = found.of[found.count - 1];
      stretch.low = s;
      if (phi.value < stretch.deepest) {
        stretch.deepest = phi.value;
        stretch.deepest_place = place;
      }
    } else if (before == Side::inside && side == Side::outside) {
      found.of[found.count - 1].face_low = normal_at(place);
    }
    if (!(s > far_)) break;
    before = side;
    last = place;
    s = std::max(far_, s - std::max(std::abs(phi.value), kCoreStep * width_));
  }
  return 0.5 * nearest;  // between two looks it may be half as far
}

/// Matches the stretches that are inside now with those of the look before, which hand on the face of their entry.
void CorePassage::compare(const Vec3& position, const Vec3& axis, Stretches& now, double time) noexcept {
  std::array<bool, std::tuple_size_v<decltype(inside_.of)>> stays{};
  const auto through = [this, time](const Vec3& entered, const Vec3& left, bool at_once) {
    if (!event_) event_ = {time, entered, left, at_once};
  };
  for (std::size_t i = 0; i < now.count; ++i) {
    Stretch& next = now.of[i];
    const auto place = [&](double s) { return Vec3(position + s * axis); };
    if (next.face_low && next.face_high && look_away(*next.face_low, *next.face_high))
      through(place(next.high), place(next.low), true);
    const Stretch* was = nullptr;
    for (std::size_t k = 0; k < inside_.count; ++k) {
      const Stretch& old = inside_.of[k];
      if (old.low > next.high || next.low > old.high) continue;
      stays[k] = true;
      if (was == nullptr) was = &old;
    }
    if (was == nullptr) {
      next.entered = next.deepest_place;
      next.normal = normal_at(next.deepest_place);
      next.own_low = next.low;
      next.own_high = next.high;
      continue;
    }
    next.entered = was->entered;
    next.normal = was->normal;
    // An end that comes out by a face opposite to the entry's has gone through, unless that end had come in by it.
    const bool away_low = next.face_low && look_away(*next.face_low, next.normal);
    const bool away_high = next.face_high && look_away(*next.face_high, next.normal);
    if (away_low && next.low > was->own_low) through(next.entered, place(next.low), false);
    if (away_high && next.high < was->own_high) through(next.entered, place(next.high), false);
    next.own_low = away_low ? std::max(was->own_low, next.low) : next.low;
    next.own_high = away_high ? std::min(was->own_high, next.high) : next.high;
  }
  if (!follows_) return;
  for (std::size_t k = 0; k < inside_.count; ++k) {
    const Stretch& old = inside_.of[k];
    const Vec3 middle = position + 0.5 * (old.own_low + old.own_high) * axis;
    if (stays[k]) continue;
    const SurfaceDistance phi = solid_->at(middle);
    if (phi.known && phi.value > 0.0 && look_away(normal_at(middle), old.normal)) through(old.entered, middle, false);
  }
}

}  // namespace hapbench
