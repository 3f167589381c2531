#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/math.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/motion.hpp"
#include "sim/tool/tool_shape.hpp"

/// Operations on packs of eight points that solids of revolution share. Include from source files only (see
/// simd.hpp).
namespace hapbench {

/// Distance from the axis, relative to the largest radius, below which the radial direction is dominated by
/// rounding.
inline constexpr double kOnAxis = 1e-12;
/// Exit distance [m] of a ray that does not meet a surface.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Returns the closed outline of a solid of revolution as a polyline in the axial half plane [m]. Adds the discs
/// that close the ends and, for a round tip, a quarter of a circle about the tip centre. The polyline deviates from the
/// circle by less than 0.013 % of the radius.
inline std::vector<ProfilePoint> closed_outline(std::vector<ProfilePoint> outline, Tip tip) {
  if (outline.front().rho > 0.0) outline.insert(outline.begin(), {outline.front().s, 0.0});
  const auto [s, radius] = outline.back();
  constexpr int kSegments = 48;
  for (int i = 1; tip == Tip::round && i < kSegments; ++i) {
    const double angle = std::numbers::pi / 2.0 * i / kSegments;
    outline.push_back({radius * math::sin(angle), radius * math::cos(angle)});
  }
  if (radius > 0.0) outline.push_back({tip == Tip::round ? radius : s, 0.0});
  return outline;
}

/// Eight points in the axial coordinates of the tool. (x, y, z) is the position relative to the tip centre, s its
/// component along the axis, and (rho_x, rho_y, rho_z) the radial vector from the axis to the point. All lengths in m.
/// The contact search and the depths of solids of revolution both use these numbers, so a colliding point never gets a
/// negative depth.
struct AxialPack {
  simd::Pack x, y, z;
  simd::Pack s;
  simd::Pack rho_x, rho_y, rho_z;
  simd::Pack rho2;  ///< |rho|^2

  AxialPack(const ToolPose& pose, const double* px, const double* py, const double* pz)
      : x(simd::load(px) - simd::Pack(pose.position.x())),
        y(simd::load(py) - simd::Pack(pose.position.y())),
        z(simd::load(pz) - simd::Pack(pose.position.z())) {
    const simd::Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
    s = x * ax + y * ay + z * az;
    rho_x = x - s * ax;
    rho_y = y - s * ay;
    rho_z = z - s * az;
    rho2 = rho_x * rho_x + rho_y * rho_y + rho_z * rho_z;
  }

  simd::Pack distance2() const { return x * x + y * y + z * z; }
};

/// Eight vectors, one pack per component.
struct PackVector {
  simd::Pack x, y, z;

  explicit PackVector(const Vec3& v) : x(v.x()), y(v.y()), z(v.z()) {}
  PackVector(const simd::Pack& px, const simd::Pack& py, const simd::Pack& pz) : x(px), y(py), z(pz) {}
  PackVector(const double* px, const double* py, const double* pz)
      : x(simd::load(px)), y(simd::load(py)), z(simd::load(pz)) {}

  simd::Pack dot(const PackVector& o) const { return x * o.x + y * o.y + z * o.z; }
  void store(double* px, double* py, double* pz) const {
    simd::store(x, px);
    simd::store(y, py);
    simd::store(z, pz);
  }
};

inline PackVector select(const simd::Mask& mask, const PackVector& yes, const PackVector& no) {
  return {simd::select(mask, yes.x, no.x), simd::select(mask, yes.y, no.y), simd::select(mask, yes.z, no.z)};
}

/// Returns a p + b q.
inline PackVector combined(const simd::Pack& a, const PackVector& p, const simd::Pack& b, const PackVector& q) {
  return {a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z};
}

/// Returns v / length where `defined` is set, and `other` elsewhere.
inline PackVector unit_or(const simd::Mask& defined, const PackVector& v, const simd::Pack& length,
                          const PackVector& other) {
  const simd::Pack scale = simd::Pack(1.0) / simd::select(defined, length, simd::Pack(1.0));
  return select(defined, {v.x * scale, v.y * scale, v.z * scale}, other);
}

/// Writes to `marks` one byte for each pack of the ranges, range after range: the bits of the mask that `test` returns
/// for the pack. Pose and points are passed by value. Passed by reference, they would be read from memory again after
/// every written byte, because a byte may alias any object.
template <class Test>
void mark(const ToolPose pose, const PointArrays points, std::span<const PackRange> ranges, std::uint8_t* marks,
          const Test& test) {
  for (const PackRange range : ranges) {
    std::uint8_t* const first = marks;
    for (std::size_t i = range.first * simd::lanes; i < range.last * simd::lanes; i += simd::lanes) {
      *marks++ = simd::bits(test(AxialPack(pose, points.x + i, points.y + i, points.z + i)));
    }
    if (marks == first) continue;
    *first &= range.mask_of_first;
    *(marks - 1) &= range.mask_of_last;
  }
}

/// Appends the points that pass the test to the contacts. `packs`: number of packs. Arguments are passed by value
/// for the reason given at mark().
template <class Test>
void push(const ToolPose pose, const PointColumns points, std::size_t packs, ContactBuffer& contacts, const Test test) {
  std::size_t size = contacts.size();
  for (std::size_t i = 0; i < packs * simd::lanes; i += simd::lanes) {
    const std::uint8_t hits = simd::bits(test(AxialPack(pose, points.x + i, points.y + i, points.z + i)));
    if (hits != 0) size += simd::copy_selected(hits, points, i, contacts, size);
  }
  contacts.extend(size - contacts.size());
}

/// Interval low <= s <= high of the tool's axis, measured from the tip centre [m]. Empty if low > high.
struct AxisInterval {
  double low, high;
};

/// Restricts an interval of the tool's axis to the points that may be within `radius` [m] of the box `bounds`: the
/// points in `bounds` grown by the radius on all sides. Comparisons with NaN leave the interval unchanged.
inline AxisInterval axis_interval_near(AxisInterval part, const ToolPose& pose, double radius,
                                       const Box& bounds) noexcept {
  for (int k = 0; k < 3; ++k) {
    const double a = pose.axis[k];
    const double from = bounds.min[k] - radius - pose.position[k], to = bounds.max[k] + radius - pose.position[k];
    if (a == 0.0) {
      if (from > 0.0 || to < 0.0) return {1.0, -1.0};
      continue;
    }
    part.low = std::max(part.low, (a > 0.0 ? from : to) / a);
    part.high = std::min(part.high, (a > 0.0 ? to : from) / a);
  }
  return part;
}

/// Returns the bounding box [m] of a cylinder about the axis, with the given radius, that extends over an interval of
/// the axis; an empty box if the interval is empty.
inline Box box_around(const AxisInterval& part, const ToolPose& pose, double radius) noexcept {
  if (part.low > part.high) return {Vec3::Ones(), -Vec3::Ones()};
  const Vec3 tip = pose.position + part.high * pose.axis;
  const Vec3 bottom = pose.position + part.low * pose.axis;
  // A disc perpendicular to a unit vector a has the half extent radius sqrt(1 - <a, e>^2) along a unit vector e.
  const Vec3 disc = radius * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {tip.cwiseMin(bottom) - disc, tip.cwiseMax(bottom) + disc};
}

/// Returns a row of equal balls along the axis whose union contains a cylinder of this radius and length [m]. Each ball
/// contains a slice of the cylinder that is at most as long as the cylinder is wide.
inline ToolShape::Cover row_of_balls(double radius, double length) {
  const double balls = std::ceil(length / (2.0 * radius));
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * math::hypot(radius, length / balls / 2.0)};
}

}  // namespace hapbench
