#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#ifndef EIGEN_DONT_VECTORIZE
#error "EIGEN_DONT_VECTORIZE is missing, on which layouts depend: link hapbench::sim, which brings it"
#endif

/// Basic types that all folders share. All quantities are in SI units (m, s, N, kg, rad) and double precision. The
/// world frame W is right-handed. A planar scene is a 3-D scene whose points, normals and motion have no z
/// component.
namespace hapbench {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Returns v / |v|, or `fallback` if v is zero.
inline Vec3 unit_or(const Vec3& v, const Vec3& fallback) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : fallback;
}

/// Axis-aligned box in the world frame [m]. Empty if min > max in any component.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();

  /// Returns an empty box, to be grown with add().
  static Box nothing() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  }
  Vec3 size() const { return max - min; }
  /// Enlarges the box so that it contains the point.
  void add(const Vec3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
};

/// Returns the bounding box of the points. Precondition: there is at least one point.
template <class Points>
Box box_of(const Points& points) {
  Box box{points.front(), points.front()};
  for (const Vec3& point : points) box.add(point);
  return box;
}

/// Returns the distance from a point to a box [m]; 0 inside. Precondition: the box is not empty.
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

/// Shape of the tip of a solid of revolution. `flat`: the body ends in the tip plane, which is perpendicular to the
/// axis at the tip centre. `round`: a half ball about the tip centre extends beyond the tip plane; its radius is the
/// radius of the body in this plane.
enum class Tip { flat, round };

/// Point on the profile of a solid of revolution, in the half plane that the axis bounds [m].
struct ProfilePoint {
  double s;    ///< coordinate along the axis, 0 at the tip centre and negative towards the shank
  double rho;  ///< distance from the axis, >= 0

  bool operator==(const ProfilePoint&) const = default;
};

/// Selects whether a run may skip computations that do not change its results. `off` computes everything by brute
/// force, also values that nothing reads. Tests use `off` to verify that skips do not change the output. A scenario
/// file has no field for this setting; RenderingConfig::skips holds it.
enum class Skips { on, off };

/// Allowed values of a number that the user sets: from `min` to `max`. `max` is allowed; `min` is allowed if
/// `above_min` is false. Messages print the unit: an SI unit, "1" for a dimensionless number, or empty if the number
/// has the same unit as another number.
struct NumberRange {
  double min;
  double max;
  const char* unit = "";
  bool above_min = false;  ///< true if min itself is not allowed
};

/// Parameter of a model: the scenario field that sets it, with its unit and range.
struct Parameter {
  const char* field;
  NumberRange range;
};

/// Parameter with a description of its meaning in the model.
struct ParameterInfo {
  Parameter parameter;
  const char* meaning;
};

/// Description of a model, defined at the top of the model's source file. `hapbench describe NAME` prints it.
struct ModelInfo {
  const char* name;
  const char* summary;
  const char* formula;
  const char* source;  ///< section of the thesis, or the paper
  const char* known_failure;
  std::span<const ParameterInfo> parameters = {};
};

}  // namespace hapbench
