#include "tests/support/tool_meshes.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/meshes.hpp"

namespace hapbench::test {
namespace {

double volume(const TriangleSoup& soup) {
  double sum = 0.0;
  for (const auto& t : soup.triangles) sum += soup.vertices[t[0]].dot(soup.vertices[t[1]].cross(soup.vertices[t[2]]));
  return sum / 6.0;
}

double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 way = b - a;
  const double t = way.squaredNorm() > 0.0 ? (p - a).dot(way) / way.squaredNorm() : 0.0;
  return (p - a - std::min(1.0, std::max(0.0, t)) * way).norm();
}

/// By barycentric coordinates of the foot of the perpendicular.
double distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  double nearest = std::min({distance_to_segment(a, b, p), distance_to_segment(b, c, p), distance_to_segment(c, a, p)});
  Eigen::Matrix<double, 3, 2> sides;
  sides << b - a, c - a;
  const Eigen::Matrix2d gram = sides.transpose() * sides;
  if (gram.determinant() <= 0.0) return nearest;
  const Eigen::Vector2d uv = gram.inverse() * (sides.transpose() * (p - a));
  if (uv.minCoeff() >= 0.0 && uv.sum() <= 1.0) nearest = std::min(nearest, (p - a - sides * uv).norm());
  return nearest;
}

}  // namespace

TriangleSoup swept(const std::vector<std::pair<double, double>>& polygon, int sides) {
  const int n = static_cast<int>(polygon.size());
  TriangleSoup soup = sheet(n, sides, [&](int i, int j) {
    const auto& [rho, z] = polygon[static_cast<std::size_t>(i % n)];
    const double a = 2.0 * std::numbers::pi * (j % sides) / sides;
    return Vec3(rho == 0.0 ? 0.0 : rho * std::cos(a), rho == 0.0 ? 0.0 : rho * std::sin(a), z);
  });
  // What the axis sweeps is no surface.
  std::erase_if(soup.triangles, [&v = soup.vertices](const auto& t) {
    return v[t[0]] == v[t[1]] || v[t[1]] == v[t[2]] || v[t[2]] == v[t[0]];
  });
  return volume(soup) < 0.0 ? reversed(std::move(soup)) : soup;
}

TriangleSoup cylinder_mesh(double radius, double length, int sides) {
  return swept({{0.0, 0.0}, {radius, 0.0}, {radius, length}, {0.0, length}}, sides);
}

TriangleSoup cup(int sides) {
  return swept({{0.0, 0.0}, {1.0, 0.0}, {1.0, 2.0}, {0.7, 2.0}, {0.7, 0.3}, {0.0, 0.3}}, sides);
}

TriangleSoup scaled(TriangleSoup soup, double factor, const Vec3& shift) {
  for (Vec3& v : soup.vertices) v = factor * v + shift;
  return soup;
}

std::shared_ptr<const SignedDistanceGrid> grid_of(const TriangleSoup& soup, double spacing) {
  return std::make_shared<const SignedDistanceGrid>(soup.vertices, soup.triangles, spacing);
}

double exact_distance(const TriangleSoup& soup, const Vec3& point) {
  double distance = std::numeric_limits<double>::infinity(), angle = 0.0;
  for (const auto& t : soup.triangles) {
    const Vec3 &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    distance = std::min(distance, distance_to_triangle(a, b, c, point));
    const Vec3 x = a - point, y = b - point, z = c - point;
    angle += 2.0 * std::atan2(x.dot(y.cross(z)), x.norm() * y.norm() * z.norm() + x.dot(y) * z.norm() +
                                                     y.dot(z) * x.norm() + z.dot(x) * y.norm());
  }
  return angle > 2.0 * std::numbers::pi ? -distance : distance;
}

}  // namespace hapbench::test
