#include "tests/support/meshes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace hapbench::test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

double volume(const TriangleSoup& soup) {
  double sum = 0.0;
  for (const auto& t : soup.triangles) sum += soup.vertices[t[0]].dot(soup.vertices[t[1]].cross(soup.vertices[t[2]]));
  return sum / 6.0;
}

double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 segment = b - a;
  const double t = segment.squaredNorm() > 0.0 ? (p - a).dot(segment) / segment.squaredNorm() : 0.0;
  return (p - a - std::min(1.0, std::max(0.0, t)) * segment).norm();
}

/// Returns the distance of p from a triangle. The foot of the perpendicular is tested by its barycentric
/// coordinates.
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

TriangleSoup cube(double half, const Vec3& centre) {
  TriangleSoup soup;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    soup.vertices.push_back(centre + half * signs);
  }
  const std::uint32_t quads[][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    soup.triangles.push_back({q[0], q[1], q[2]});
    soup.triangles.push_back({q[0], q[2], q[3]});
  }
  return soup;
}

TriangleSoup sphere(double radius, int levels) {
  TriangleSoup soup;
  for (const double sign : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) soup.vertices.push_back(sign * Vec3::Unit(axis));
  }
  // Each octant has one triangle. An odd number of negative axes reverses the triangle's orientation.
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::uint32_t x = 3 * (octant & 1), y = 1 + 3 * (octant >> 1 & 1), z = 2 + 3 * (octant >> 2 & 1);
    const bool odd = ((octant ^ octant >> 1 ^ octant >> 2) & 1) != 0;
    soup.triangles.push_back(odd ? TriangleSoup::Triangle{x, z, y} : TriangleSoup::Triangle{x, y, z});
  }
  for (int level = 0; level < levels; ++level) {
    for (const TriangleSoup::Triangle& t : std::exchange(soup.triangles, {})) {
      const auto base = static_cast<std::uint32_t>(soup.vertices.size());
      for (std::size_t i = 0; i < 3; ++i)
        soup.vertices.push_back((soup.vertices[t[i]] + soup.vertices[t[(i + 1) % 3]]).normalized());
      soup.triangles.push_back({t[0], base, base + 2});
      soup.triangles.push_back({base, t[1], base + 1});
      soup.triangles.push_back({base + 2, base + 1, t[2]});
      soup.triangles.push_back({base, base + 1, base + 2});
    }
  }
  for (Vec3& v : soup.vertices) v *= radius;
  return soup;
}

TriangleSoup sheet(int n, int m, const std::function<Vec3(int, int)>& position) {
  TriangleSoup soup;
  const auto index = [m](int i, int j) { return static_cast<std::uint32_t>(i * (m + 1) + j); };
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) soup.vertices.push_back(position(i, j));
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      soup.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      soup.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return soup;
}

TriangleSoup torus(int n, int m) {
  return sheet(n, m, [=](int i, int j) {
    const double a = kTurn * (i % n) / n, b = kTurn * (j % m) / m;
    return Vec3((2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b));
  });
}

TriangleSoup moebius_band(int n) {
  return sheet(n, 2, [n](int i, int j) {
    // After one turn, the two borders are exchanged. They must join bit for bit.
    const int across = i == n ? 1 - j : j - 1;
    const double a = kTurn * (i % n) / n;
    const double r = 2 + across * std::cos(a / 2);
    return Vec3(r * std::cos(a), r * std::sin(a), across * std::sin(a / 2));
  });
}

TriangleSoup klein_bottle(int n, int m) {
  return sheet(n, m, [=](int i, int j) {
    const int around = i == n ? (2 * m - j) % m : j % m;
    const double a = kTurn * (i % n) / n, b = kTurn * around / m;
    const double r = 3 + std::cos(a / 2) * std::sin(b) - std::sin(a / 2) * std::sin(2 * b);
    return Vec3(r * std::cos(a), r * std::sin(a), std::sin(a / 2) * std::sin(b) + std::cos(a / 2) * std::sin(2 * b));
  });
}

TriangleSoup together(TriangleSoup a, const TriangleSoup& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const TriangleSoup::Triangle& t : b.triangles)
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

TriangleSoup reversed(TriangleSoup soup) {
  for (TriangleSoup::Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

DensityField noise(std::uint64_t seed) {
  const auto value = [seed](const Vec3& p) {
    std::uint64_t h = seed;
    for (const double c : {p.x(), p.y(), p.z()}) {
      h = (h ^ std::bit_cast<std::uint64_t>(std::round(c * 2.0))) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return 1e-9 * (static_cast<double>(h >> 11) * 0x1.0p-52 - 1.0);
  };
  DensityField field;
  field.min = {-3, -3, -3};
  field.max = {3, 3, 3};
  field.spacing = 1.0;
  field.signed_distance = [value](const Vec3& p) { return p.cwiseAbs().maxCoeff() > 3.2 ? 1e-9 : value(p); };
  return field;
}

HalfEdgeMesh half_edge_mesh(const IsoSurface& surface) {
  HalfEdgeMesh mesh;
  std::vector<OpenMesh::VertexHandle> vertices;
  for (const SurfacePoint& v : surface.vertices)
    vertices.push_back(mesh.add_vertex({v.position.x(), v.position.y(), v.position.z()}));
  for (const auto& [a, b, c] : surface.triangles)
    EXPECT_TRUE(mesh.add_face(vertices[a], vertices[b], vertices[c]).is_valid());
  return mesh;
}

double enclosed_volume(const HalfEdgeMesh& mesh) {
  double sum = 0.0;
  for (const auto face : mesh.faces()) {
    auto corner = mesh.cfv_begin(face);
    const auto a = mesh.point(*corner++), b = mesh.point(*corner++), c = mesh.point(*corner);
    sum += (a | (b % c)) / 6.0;
  }
  return sum;
}

double surface_area(const HalfEdgeMesh& mesh) {
  double sum = 0.0;
  for (const auto face : mesh.faces()) sum += mesh.calc_face_area(face);
  return sum;
}

long euler_characteristic(const HalfEdgeMesh& mesh) {
  return static_cast<long>(mesh.n_vertices()) - static_cast<long>(mesh.n_edges()) + static_cast<long>(mesh.n_faces());
}

TriangleSoup swept(const std::vector<std::pair<double, double>>& polygon, int sides) {
  const int n = static_cast<int>(polygon.size());
  TriangleSoup soup = sheet(n, sides, [&](int i, int j) {
    const auto& [rho, z] = polygon[static_cast<std::size_t>(i % n)];
    const double a = 2.0 * std::numbers::pi * (j % sides) / sides;
    return Vec3(rho == 0.0 ? 0.0 : rho * std::cos(a), rho == 0.0 ? 0.0 : rho * std::sin(a), z);
  });
  // Edges on the axis generate no surface.
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
  return std::make_shared<const SignedDistanceGrid>(ClosedSurface(soup.vertices, soup.triangles), spacing);
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
