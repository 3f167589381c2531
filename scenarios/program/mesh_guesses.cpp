#include "scenarios/program/mesh_guesses.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <optional>

#include "device_model/hands/drag_hand.hpp"

namespace hapbench {
namespace {

/// Mean and variance of a surface.
struct Spread {
  Vec3 middle;
  Mat3 variance;  ///< about the middle [m^2]
};

Spread spread_of(const TriangleSoup& mesh) {
  double area = 0.0;
  Vec3 sum = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double weight = (q - p).cross(r - p).norm();
    // The mean of a quadratic over a triangle is its mean over the middles of the sides.
    for (const Vec3& place : {Vec3(0.5 * (p + q)), Vec3(0.5 * (q + r)), Vec3(0.5 * (r + p))}) {
      sum += weight / 3.0 * place;
      second += weight / 3.0 * place * place.transpose();
    }
    area += weight;
  }
  const Vec3 middle = sum / area;
  return {middle, second / area - middle * middle.transpose()};
}

/// The direction along which a surface is clearly longest; a coordinate axis when it is near one.
std::optional<Vec3> longest_direction(const Mat3& variance) {
  constexpr double kStandsOut = 2.0;  // ratio of variances
  // Cosine of 6 degrees: tools are modelled along an axis, but are seldom exactly symmetric about it.
  constexpr double kNearAxis = 0.995;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(variance);
  if (principal.eigenvalues()[2] < kStandsOut * principal.eigenvalues()[1]) return std::nullopt;
  const Vec3 direction = principal.eigenvectors().col(2);
  Eigen::Index nearest = 0;
  return direction.cwiseAbs().maxCoeff(&nearest) > kNearAxis ? Vec3(-Vec3::Unit(nearest)) : direction;
}

/// The end of a mesh along a direction.
struct End {
  Vec3 place;        ///< the middle of the last hundredth's vertices, moved to the very end
  double thickness;  ///< mean distance of the last tenth's vertices from the line through the mesh's middle
};

End end_along(const TriangleSoup& mesh, const Vec3& direction, const Vec3& middle) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Vec3& vertex : mesh.vertices) {
    least = std::min(least, direction.dot(vertex - middle));
    most = std::max(most, direction.dot(vertex - middle));
  }
  Vec3 aside = Vec3::Zero();
  double thickness = 0.0, in_tenth = 0.0, in_hundredth = 0.0;
  for (const Vec3& vertex : mesh.vertices) {
    const double along = direction.dot(vertex - middle), from_end = (most - along) / (most - least);
    const Vec3 across = vertex - middle - along * direction;
    if (from_end <= 0.1) thickness += across.norm(), in_tenth += 1.0;
    if (from_end <= 0.01) aside += across, in_hundredth += 1.0;
  }
  return {middle + most * direction + aside / in_hundredth, thickness / in_tenth};
}

}  // namespace

TipOfMesh guess_tip(const TriangleSoup& mesh) {
  const auto [middle, variance] = spread_of(mesh);
  const std::optional<Vec3> longest = longest_direction(variance);
  const Vec3 direction = longest.value_or(-Vec3::UnitZ());
  const End end = end_along(mesh, direction, middle), other = end_along(mesh, -direction, middle);
  if (longest && other.thickness < end.thickness) return {other.place, -direction};
  return {end.place, direction};
}

Vec3 middle_of_the_top(const std::vector<SurfacePoint>& points, double top, double tolerance) {
  std::vector<Vec3> high;
  for (const SurfacePoint& point : points) {
    if (point.position.z() >= top - tolerance) high.push_back(point.position);
  }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& place : high) middle += place;
  middle /= static_cast<double>(high.size());
  return *std::ranges::min_element(high, {}, [&middle](const Vec3& place) { return (place - middle).norm(); });
}

Vec3 top_of_the_middle(const std::vector<SurfacePoint>& points, const Box& box, double aside) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  Vec3 top(middle.x(), middle.y(), box.min.z());
  for (const SurfacePoint& point : points) {
    if ((point.position - middle).head<2>().norm() <= aside && point.position.z() > top.z()) top = point.position;
  }
  return top.z() > box.min.z() ? top : middle;
}

DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough) {
  constexpr double kFurther = 1.1;
  const Box box = shell.bounds();
  const double furthest = (box.max - box.min).norm();
  DragStart best{positions.front(), Vec3::UnitX(), smoothing, 0.0};
  for (const double radius : {smoothing, 2.0 * smoothing, 4.0 * smoothing}) {
    const SmoothedSurface surface(shell, radius);
    for (const Vec3& position : positions) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
        const double room = SurfacePath::along(surface, position, direction, furthest).length();
        if (room > kFurther * best.room) best = {position, direction, radius, room};
      }
      if (best.room >= enough) return best;
    }
  }
  return best;
}

}  // namespace hapbench
