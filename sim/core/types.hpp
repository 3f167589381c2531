#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#ifndef EIGEN_DONT_VECTORIZE
#error "EIGEN_DONT_VECTORIZE is missing, on which layouts depend: link hapbench::sim, which brings it"
#endif

/// Small types that all folders share. SI units (m, s, N, kg, rad) and double precision everywhere; world frame W,
/// right-handed. A planar scene is a 3-D scene whose points, normals and motion have no z component.
namespace hapbench {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// The vector divided by its length; `otherwise` if that is zero.
inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : otherwise;
}

/// An axis-aligned box in the world frame [m]. Empty when min > max.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();

  /// The box around no points.
  static Box nothing() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  }
  Vec3 size() const { return max - min; }
  /// Grows until the point is inside.
  void add(const Vec3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
};

/// The box around points, of which there is at least one.
template <class Points>
Box box_of(const Points& points) {
  Box box{points.front(), points.front()};
  for (const Vec3& point : points) box.add(point);
  return box;
}

/// Distance of a point from a box that is not empty [m]; 0 inside.
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

/// The end of a solid of revolution: a plane, or beyond that plane half a ball of the same radius about the tip centre.
enum class Tip { flat, round };

/// A point of a solid of revolution's profile in the axial half plane [m].
struct ProfilePoint {
  double s;    ///< along the axis from the tip centre, <= 0 towards the shank
  double rho;  ///< distance from the axis, >= 0

  bool operator==(const ProfilePoint&) const = default;
};

/// Whether a run may skip work that cannot change its results; `off` computes everything, by brute force, even if
/// nothing reads it, and exists to test that the output is identical. Therefore no field of a scenario file, although a
/// scenario in memory carries it (RenderingConfig).
enum class Skips { on, off };

/// Allowed values of a number given by a user; bounds are included unless stated otherwise. The unit is shown to
/// people: an SI unit, "1" for a dimensionless number, empty if it is the unit of another number.
struct NumberRange {
  double min;
  double max;
  const char* unit = "";
  bool above_min = false;  ///< min itself is excluded
};

/// A parameter: the scenario field that sets it, with unit and range.
struct Parameter {
  const char* field;
  NumberRange range;
};

/// The meaning of a parameter in a model.
struct ParameterInfo {
  Parameter parameter;
  const char* meaning;
};

/// The documented parameter block at the top of each model's source file; `hapbench describe NAME` prints it.
struct ModelInfo {
  const char* name;
  const char* summary;
  const char* formula;
  const char* source;  ///< place in the thesis, or the paper
  const char* known_failure;
  std::span<const ParameterInfo> parameters = {};
};

}  // namespace hapbench
