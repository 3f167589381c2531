#include "sim/mesh/half_edge_mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "sim/core/random.hpp"
#include "sim/mesh/mesh_from_triangles.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::resample_test {
namespace {

using test::cases;
using test::enclosed_volume;
using test::surface_area;

double longest_edge(const HalfEdgeMesh& mesh) {
  double longest = 0.0;
  for (const auto edge : mesh.edges()) longest = std::max(longest, mesh.calc_edge_length(edge));
  return longest;
}

/// Triangles around one vertex; many of them slivers.
HalfEdgeMesh random_fan(Random& random) {
  const double flatness = std::pow(10.0, random.uniform(-3.0, 0.0));
  const auto triangles = static_cast<int>(1 + random.below(4));
  return mesh_from_triangles(test::sheet(triangles, 1,
                                         [&](int, int j) {
                                           return j == 0 ? Vec3::Zero().eval()
                                                         : Vec3(random.uniform(-1, 1), flatness * random.uniform(-1, 1),
                                                                flatness * random.uniform(-1, 1));
                                         }))
      .mesh;
}

TEST(Refine, LeavesNoLongerEdgeAndTheSameSurface) {
  HalfEdgeMesh mesh = mesh_from_triangles(test::torus(9, 7)).mesh;
  const double area = surface_area(mesh), volume = enclosed_volume(mesh);
  const long euler = test::euler_characteristic(mesh);
  refine(mesh, 0.05);
  EXPECT_LE(longest_edge(mesh), 0.05);
  EXPECT_GT(longest_edge(mesh), 0.025) << "no finer than asked for";
  EXPECT_EQ(test::euler_characteristic(mesh), euler);
  // Sums of some 1e5 terms, each rounded when it is added: relative 1e5 * 2^-53.
  EXPECT_NEAR(surface_area(mesh) / area, 1.0, 3e-11);
  EXPECT_NEAR(enclosed_volume(mesh) / volume, 1.0, 3e-11);
}

TEST(Refine, LeavesAFineMeshAlone) {
  HalfEdgeMesh mesh = mesh_from_triangles(test::sphere(1.0, 3)).mesh;
  const std::size_t faces = mesh.n_faces();
  refine(mesh, 2.0);
  EXPECT_EQ(mesh.n_faces(), faces);
}

TEST(RefinedFaceCount, IsExactlyWhatRefineLeaves) {
  Random random(4);
  for (std::size_t i = 0; i < cases(300); ++i) {
    HalfEdgeMesh mesh = random_fan(random);
    const double spacing = std::pow(10.0, random.uniform(-2.0, 0.0));
    const double expected = refined_face_count(mesh, spacing, 1e9);
    refine(mesh, spacing);
    EXPECT_EQ(static_cast<double>(mesh.n_faces()), expected) << spacing;
    EXPECT_LE(longest_edge(mesh), spacing);
  }
}

TEST(RefinedFaceCount, StopsCountingWhereNobodyWouldRefine) {
  const HalfEdgeMesh mesh = mesh_from_triangles(test::cube()).mesh;
  for (const double spacing : {1e-6, 1e-100, 1e-300, 5e-324}) {
    EXPECT_GT(refined_face_count(mesh, spacing, 1e5), 1e5) << spacing;
  }
}

TEST(Refine, NormalsOnASphereAreWithinTheAngleOfItsFacets) {
  constexpr double kRadius = 0.005;
  HalfEdgeMesh mesh = mesh_from_triangles(test::sphere(kRadius, 4)).mesh;
  double widest = 0.0;  // circumscribed circle of a facet
  for (const auto face : mesh.faces()) {
    double product = 1.0;
    for (auto edge = mesh.cfe_iter(face); edge.is_valid(); ++edge) product *= mesh.calc_edge_length(*edge);
    widest = std::max(widest, product / (4.0 * mesh.calc_face_area(face)));
  }
  refine(mesh, 0.0002);
  const auto points = vertices_with_normals(mesh);
  ASSERT_GT(points.size(), 5000u);
  // A facet's normal is the sphere's at the centre of its circle, and so within asin(r / R) of the sphere's at any
  // other place of the facet; the mean of normals within a cone lies in it too.
  const double angle = std::asin(widest / kRadius);
  double worst = 0.0;
  for (const SurfacePoint& p : points)
    worst = std::max(worst, std::acos(std::min(1.0, p.normal.dot(p.position.normalized()))));
  EXPECT_LE(worst, angle);
  EXPECT_GT(worst, angle / 3);
  EXPECT_LT(angle, 0.1);
}

using Place = std::array<int, 5>;
Place place_of(const SurfacePoint& p, double spacing) {
  Eigen::Index axis = 0;
  p.normal.cwiseAbs().maxCoeff(&axis);
  const auto along = [&](int i) { return static_cast<int>(std::floor(p.position[i] / spacing + 0.5)); };
  return {along(0), along(1), along(2), static_cast<int>(axis), p.normal[axis] < 0 ? -1 : 1};
}

TEST(Thinned, KeepsTheMostCentralPointOfEachCubeAndDirection) {
  HalfEdgeMesh mesh = mesh_from_triangles(test::sphere(1.0, 4)).mesh;
  const auto points = vertices_with_normals(mesh);
  const double spacing = 0.25;
  const auto thin = thinned(points, spacing);
  EXPECT_LT(thin.size(), points.size() / 2);
  const auto off_centre = [spacing](const SurfacePoint& p) {
    return (p.position / spacing - Vec3((p.position / spacing).array().round())).norm() * spacing;
  };
  std::map<Place, double> kept;
  for (const SurfacePoint& p : thin) EXPECT_TRUE(kept.emplace(place_of(p, spacing), off_centre(p)).second);
  for (const SurfacePoint& p : points) {
    const auto found = kept.find(place_of(p, spacing));
    ASSERT_NE(found, kept.end());
    EXPECT_LE(found->second, off_centre(p) + 1e-15);
  }
  EXPECT_EQ(thinned(thin, spacing).size(), thin.size());
}

TEST(Thinned, KeepsBothSidesOfAThinWallTheOrderAndTheFirstOfEquals) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 10; ++i) {
    points.push_back({{0.1 * i, 0.001, 0.0}, {0, 1, 0}});
    points.push_back({{0.1 * i, -0.001, 0.0}, {0, -1, 0}});
  }
  const auto thin = thinned(points, 1.0);
  ASSERT_EQ(thin.size(), 4u);  // cubes around 0 and 1, two sides each
  EXPECT_EQ(thin[0].position, points[0].position);
  EXPECT_EQ(thin[1].position, points[1].position);
  EXPECT_EQ(thin[2].position, points[18].position);
  EXPECT_EQ(thin[3].position, points[19].position);
  points = {{{0.25, 0, 0}, {0, 1, 0}}, {{-0.25, 0, 0}, {0, 1, 0}}};
  EXPECT_EQ(thinned(points, 1.0).at(0).position, points[0].position);
}

}  // namespace
}  // namespace hapbench::resample_test
