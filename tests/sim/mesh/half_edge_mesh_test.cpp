#include "sim/mesh/half_edge_mesh.hpp"

#include <gtest/gtest.h>

#include <OpenMesh/Tools/Subdivider/Uniform/LongestEdgeT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "sim/core/random.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::half_edge_mesh_test {
namespace {

using test::cases;
using test::cube;
using test::enclosed_volume;
using test::euler_characteristic;
using test::reversed;
using test::together;
using Triangle = TriangleSoup::Triangle;

std::string refusal_of(const TriangleSoup& soup) {
  try {
    mesh_from_triangles(soup);
  } catch (const MeshError& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

/// Returns the same triangles with separate vertices for each triangle, as in STL.
TriangleSoup exploded(const TriangleSoup& soup) {
  TriangleSoup loose;
  for (const Triangle& t : soup.triangles) {
    const auto base = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t v : t) loose.vertices.push_back(soup.vertices[v]);
    loose.triangles.push_back({base, base + 1, base + 2});
  }
  return loose;
}

TriangleSoup of_mesh(const HalfEdgeMesh& mesh) {
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) soup.vertices.push_back({mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]});
  for (const auto f : mesh.faces()) {
    Triangle t{};
    std::size_t i = 0;
    for (auto v = mesh.cfv_iter(f); v.is_valid(); ++v) t[i++] = static_cast<std::uint32_t>(v->idx());
    soup.triangles.push_back(t);
  }
  return soup;
}

TriangleSoup shuffled(TriangleSoup soup, Random& random) {
  for (std::size_t i = soup.triangles.size(); i > 1; --i)
    std::swap(soup.triangles[i - 1], soup.triangles[random.below(i)]);
  for (Triangle& t : soup.triangles) std::rotate(t.begin(), t.begin() + static_cast<long>(random.below(3)), t.end());
  return soup;
}

void expect_nothing_found(const MeshFindings& found) {
  EXPECT_EQ(found.degenerate_triangles, 0u);
  EXPECT_EQ(found.flipped_triangles, 0u);
  EXPECT_EQ(found.inverted_parts, 0u);
  EXPECT_EQ(found.open_edges.size(), 0u);
}

TEST(MeshFromTriangles, WeldsEqualPositions) {
  TriangleSoup loose = exploded(cube());
  ASSERT_EQ(loose.vertices.size(), 36u);
  EXPECT_EQ(mesh_from_triangles(loose).mesh.n_vertices(), 8u);
  // Zeros of both signs are the same position; the next double after 1 is another position.
  for (Vec3& v : loose.vertices) v.z() += 1.0;
  for (std::size_t i = 0; i < loose.vertices.size(); i += 2) {
    if (loose.vertices[i].z() == 0.0) loose.vertices[i].z() = -0.0;
  }
  EXPECT_EQ(mesh_from_triangles(loose).mesh.n_vertices(), 8u);
  loose.vertices[0].x() = std::nextafter(loose.vertices[0].x(), 2.0);
  const CheckedMesh torn = mesh_from_triangles(loose);
  EXPECT_EQ(torn.mesh.n_vertices(), 9u);
  EXPECT_GT(torn.findings.open_edges.size(), 0u);
}

TEST(MeshFromTriangles, LeavesOutUnusedVerticesAndTrianglesWithEqualCorners) {
  TriangleSoup soup = together({{{9, 9, 9}}, {}}, cube());
  soup.triangles.push_back({1, 1, 2});
  soup.vertices.push_back(soup.vertices[1]);
  soup.triangles.push_back({1, 3, 9});  // vertex 9 is at the position of vertex 1
  const auto [mesh, found] = mesh_from_triangles(soup);
  EXPECT_EQ(mesh.n_vertices(), 8u);
  EXPECT_EQ(found.degenerate_triangles, 2u);
  EXPECT_EQ(found.open_edges.size(), 0u);
}

TEST(MeshFromTriangles, CutsTheSurfaceAlongEdgesWithMoreThanTwoFaces) {
  TriangleSoup winged = cube();
  winged.vertices.push_back({0, 0, 5});
  winged.triangles.push_back({4, 5, 8});
  const struct {
    TriangleSoup soup;
    std::size_t crowded, boundary, vertices;
  } cases[] = {
      {winged, 1, 2, 8 + 3},
      {together(cube(), cube(1.0, {2, 2, 0})), 1, 0, 8 + 8},
  };
  for (const auto& c : cases) {
    const auto [mesh, found] = mesh_from_triangles(c.soup);
    EXPECT_EQ(found.non_manifold_edges.size(), c.crowded);
    EXPECT_EQ(found.open_edges.size(), c.boundary);
    EXPECT_EQ(found.flipped_triangles, 0u);
    EXPECT_EQ(mesh.n_faces(), c.soup.triangles.size());
    EXPECT_EQ(mesh.n_vertices(), c.vertices);
  }
  // Triangles that touch the cube at an edge or a corner do not change the cube's normals.
  const auto expected = vertices_with_normals(mesh_from_triangles(cube()).mesh);
  const auto points = vertices_with_normals(mesh_from_triangles(winged).mesh);
  for (const SurfacePoint& e : expected) {
    EXPECT_EQ(std::count_if(points.begin(), points.end(),
                            [&e](const SurfacePoint& p) { return p.position == e.position && p.normal == e.normal; }),
              1);
  }
}

TEST(MeshFromTriangles, KeepsTheFirstOfTrianglesWithTheSameCorners) {
  TriangleSoup soup = cube();
  const auto [a, b, c] = soup.triangles[0];
  soup.triangles.insert(soup.triangles.end(), {{b, c, a}, {c, b, a}, {a, b, c}});
  const auto [mesh, found] = mesh_from_triangles(soup);
  EXPECT_EQ(mesh.n_faces(), 12u);
  EXPECT_EQ(mesh.n_vertices(), 8u);
  EXPECT_EQ(found.repeated_triangles, 2u);
  EXPECT_EQ(found.opposite_triangles, 1u);
  EXPECT_FALSE(found.is_double_sided);
  expect_nothing_found(found);
  // Every triangle is present in both windings. The mesh keeps the winding that comes first, here the outward winding.
  const TriangleSoup both = together(cube(), reversed(cube()));
  const CheckedMesh double_sided = mesh_from_triangles(both);
  EXPECT_TRUE(double_sided.findings.is_double_sided);
  EXPECT_EQ(double_sided.findings.opposite_triangles, 12u);
  EXPECT_EQ(enclosed_volume(double_sided.mesh), 8.0);
}

TEST(MeshFromTriangles, DescribesComponents) {
  const TriangleSoup hollow = together(cube(3.0), reversed(cube(1.0, {0.5, 0, 0})));
  const CheckedMesh mesh = mesh_from_triangles(together(hollow, reversed(cube(0.5, {9, 0, 0}))));
  EXPECT_EQ(mesh.findings.component_count, 3u);
  ASSERT_EQ(mesh.findings.components.size(), 3u);
  const auto& found = mesh.findings.components;
  EXPECT_EQ(found[0].box.max, Vec3(3, 3, 3));
  EXPECT_EQ(found[1].box.max, Vec3(1.5, 1, 1));
  EXPECT_EQ(found[2].box.max, Vec3(9.5, 0.5, 0.5));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found[i].triangles, 12u);
    EXPECT_TRUE(found[i].is_closed);
    EXPECT_EQ(found[i].is_cavity, i == 1);
    EXPECT_EQ(found[i].is_reversed, i == 2);
  }
  EXPECT_EQ(largest_component(mesh.mesh).triangles.size(), 12u);
  EXPECT_EQ(mesh_from_triangles(largest_component(mesh.mesh)).findings.components[0].box.max, Vec3(3, 3, 3));
}

TEST(MeshFromTriangles, HoldsWhateverTrianglesThereAre) {
  Random random(4);
  std::size_t held = 0, crowded = 0;
  for (std::size_t round = 0; round < cases(3000); ++round) {
    TriangleSoup soup;
    const std::uint64_t vertices = 4 + random.below(6);
    for (std::uint64_t i = 0; i < vertices; ++i) soup.vertices.push_back(random.direction());
    for (std::uint64_t n = 1 + random.below(12); n > 0; --n) {
      Triangle t{};
      for (std::uint32_t& corner : t) corner = static_cast<std::uint32_t>(random.below(vertices));
      soup.triangles.push_back(t);
    }
    try {
      const auto [mesh, found] = mesh_from_triangles(soup);
      EXPECT_EQ(mesh.n_faces(), soup.triangles.size() - found.degenerate_triangles - found.repeated_triangles -
                                    found.opposite_triangles);
      ++held;
      if (!found.non_manifold_edges.empty()) ++crowded;
    } catch (const MeshError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with("is not orientable") || message.starts_with("has no faces")) << message;
    }
  }
  // A large fraction of the meshes has edges with more than two triangles, after equal triangles were removed.
  EXPECT_GT(crowded, held / 6);
}

TEST(MeshFromTriangles, RefusesSurfacesWithOneSide) {
  EXPECT_NE(refusal_of(test::moebius_band(12)).find("is not orientable"), std::string::npos);
  EXPECT_NE(refusal_of(test::klein_bottle(12, 7)).find("is not orientable"), std::string::npos);
  Random random(1);
  EXPECT_NE(refusal_of(shuffled(test::moebius_band(12), random)).find("is not orientable"), std::string::npos);
}

TEST(MeshFromTriangles, GivesEachFanAtAPointItsOwnVertex) {
  // Check two cubes that touch at a corner.
  const auto [mesh, found] = mesh_from_triangles(together(cube(), cube(1.0, {2, 2, 2})));
  expect_nothing_found(found);
  EXPECT_EQ(mesh.n_vertices(), 16u);
  std::size_t normals_out = 0;
  for (const SurfacePoint& p : vertices_with_normals(mesh)) {
    if (p.position != Vec3(1, 1, 1)) continue;
    ++normals_out;
    EXPECT_NEAR(std::abs(p.normal.dot(Vec3(1, 1, 1).normalized())), 1.0, 0.1) << "of one cube's faces only";
  }
  EXPECT_EQ(normals_out, 2u);
}

TEST(MeshFromTriangles, MakesTheWindingThatOfTheMajority) {
  Random random(2);
  for (std::size_t round = 0; round < cases(100); ++round) {
    TriangleSoup soup = exploded(test::sphere(1.0, 2));  // 128 triangles
    const std::size_t wrong = random.below(64);
    for (std::size_t i = 0; i < wrong; ++i) std::swap(soup.triangles[i][1], soup.triangles[i][2]);
    const auto [mesh, found] = mesh_from_triangles(shuffled(soup, random));
    EXPECT_EQ(found.flipped_triangles, wrong);
    EXPECT_EQ(found.inverted_parts, 0u);
    EXPECT_GT(enclosed_volume(mesh), 0.0);
    EXPECT_EQ(euler_characteristic(mesh), 2);
  }
}

TEST(MeshFromTriangles, TurnsClosedPartsOutwards) {
  const CheckedMesh one = mesh_from_triangles(reversed(cube()));
  EXPECT_EQ(one.findings.inverted_parts, 1u);
  EXPECT_EQ(one.findings.flipped_triangles, 0u);
  EXPECT_EQ(enclosed_volume(one.mesh), 8.0);
  const CheckedMesh two = mesh_from_triangles(together(cube(), reversed(cube(1.0, {900, 0, 0}))));
  EXPECT_EQ(two.findings.inverted_parts, 1u);
  EXPECT_NEAR(enclosed_volume(two.mesh), 16.0, 1e-9);  // terms up to 1e3^3 / 6 cancel, so rounding is 1e-9
}

TEST(MeshFromTriangles, KeepsCavitiesAndTurnsThemWithWhatIsAroundThem) {
  const TriangleSoup hollow = together(cube(3.0), reversed(cube(1.0, {0.5, 0, 0})));
  for (const TriangleSoup& soup : {hollow, together(reversed(cube(1.0, {0.5, 0, 0})), cube(3.0))}) {
    const auto [mesh, found] = mesh_from_triangles(soup);
    expect_nothing_found(found);
    EXPECT_NEAR(enclosed_volume(mesh), 216.0 - 8.0, 1e-12);
  }
  const CheckedMesh turned = mesh_from_triangles(reversed(hollow));
  EXPECT_EQ(turned.findings.inverted_parts, 2u);
  EXPECT_NEAR(enclosed_volume(turned.mesh), 216.0 - 8.0, 1e-12);
}

/// A part in the bounding box of a larger part is no cavity unless the larger part encloses it: of a torus and a cube
/// in its opening, only the parts that are inside out are turned.
TEST(MeshFromTriangles, TurnsAPartThatAnotherPartOnlySurrounds) {
  const TriangleSoup frame = test::torus(9, 7), ball = cube(0.1);
  const double volume = enclosed_volume(mesh_from_triangles(frame).mesh) + 0.2 * 0.2 * 0.2;
  for (const bool turned_frame : {false, true})
    for (const bool turned_ball : {false, true}) {
      const auto [mesh, found] =
          mesh_from_triangles(together(turned_frame ? reversed(frame) : frame, turned_ball ? reversed(ball) : ball));
      EXPECT_EQ(found.inverted_parts, (turned_frame ? 1u : 0u) + (turned_ball ? 1u : 0u));
      EXPECT_NEAR(enclosed_volume(mesh), volume, 1e-12 * volume);
    }
}

/// Two cubes that share an edge: four faces meet in this edge, but each cube is closed and is oriented.
TEST(MeshFromTriangles, TurnsClosedPartsThatShareAnEdge) {
  for (const bool turned : {false, true}) {
    const TriangleSoup both = together(cube(), cube(1.0, {2, 2, 0}));
    const auto [mesh, found] = mesh_from_triangles(turned ? reversed(both) : both);
    EXPECT_EQ(found.non_manifold_edges.size(), 1u);
    EXPECT_EQ(found.open_component_count, 0u);
    EXPECT_EQ(found.inverted_parts, turned ? 2u : 0u);
    EXPECT_NEAR(enclosed_volume(mesh), 16.0, 1e-12);
  }
}

/// flip_open turns the open parts only, and counts no closed part as reversed.
TEST(MeshFromTriangles, FlipsOpenPartsOnly) {
  TriangleSoup open = cube();
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);  // the top face
  const TriangleSoup both = together(open, cube(1.0, {900, 0, 0}));
  const CheckedMesh as_given = mesh_from_triangles(both), flipped = mesh_from_triangles(both, /*flip_open=*/true);
  EXPECT_EQ(flipped.findings.inverted_parts, 0u);
  EXPECT_EQ(flipped.findings.open_component_count, 1u);
  const auto given = vertices_with_normals(as_given.mesh), after = vertices_with_normals(flipped.mesh);
  ASSERT_EQ(given.size(), after.size());
  for (std::size_t i = 0; i < given.size(); ++i)
    EXPECT_EQ(after[i].normal, given[i].position.x() < 100.0 ? Vec3(-given[i].normal) : given[i].normal);
}

TEST(MeshFromTriangles, KeepsTheWindingOfOpenSurfaces) {
  TriangleSoup open = cube();
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);  // the top face
  for (const bool turned : {false, true}) {
    const auto [mesh, found] = mesh_from_triangles(turned ? reversed(open) : open);
    EXPECT_EQ(found.open_edges.size(), 4u);
    EXPECT_EQ(found.flipped_triangles, 0u);
    EXPECT_EQ(found.inverted_parts, 0u);
    const auto points = vertices_with_normals(mesh);
    ASSERT_EQ(points.size(), 8u);
    EXPECT_EQ(points[0].normal.dot(Vec3(-1, -1, -1)) > 0.0, !turned);
  }
}

TEST(MeshFromTriangles, RefusesAVertexWithVeryManyFaces) {
  const auto fan = [](int n) {
    return test::sheet(n, 1, [n](int i, int j) {
      const double a = 2.0 * std::numbers::pi * i / n;
      return j == 0 ? Vec3::Zero().eval() : Vec3(std::cos(a), std::sin(a), 1.0);
    });
  };
  EXPECT_EQ(mesh_from_triangles(fan(5000)).mesh.n_faces(), 5000u);
  EXPECT_NE(refusal_of(fan(10'001)).find("more than 10000 faces meet in the vertex at (0, 0, 0) m"), std::string::npos);
}

TEST(MeshFromTriangles, RebuildsAnySurfaceFromItsTrianglesInAnyOrder) {
  Random random(3);
  for (std::uint64_t seed = 1; seed <= cases(60); ++seed) {
    const HalfEdgeMesh original = test::half_edge_mesh(marching_cubes(test::noise(seed), {.triangles = true}));
    const auto [mesh, found] = mesh_from_triangles(shuffled(exploded(of_mesh(original)), random));
    expect_nothing_found(found);
    EXPECT_EQ(mesh.n_vertices(), original.n_vertices());
    EXPECT_EQ(mesh.n_edges(), original.n_edges());
    EXPECT_EQ(mesh.n_faces(), original.n_faces());
    // The tolerance covers the rounding of two sums of the same thousand terms, up to a few units each, in different
    // orders.
    EXPECT_NEAR(enclosed_volume(mesh), enclosed_volume(original), 1e-11);
  }
}

using test::surface_area;

double longest_edge(const HalfEdgeMesh& mesh) {
  double longest = 0.0;
  for (const auto edge : mesh.edges()) longest = std::max(longest, mesh.calc_edge_length(edge));
  return longest;
}

/// Returns triangles around one vertex, many of them slivers.
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
  // The relative rounding error of a sum of some 1e5 terms is about 1e5 * 2^-53.
  EXPECT_NEAR(surface_area(mesh) / area, 1.0, 3e-11);
  EXPECT_NEAR(enclosed_volume(mesh) / volume, 1.0, 3e-11);
}

/// Compares the index (OpenMesh handle) of every mesh element, because the indices determine the order of points, and
/// with it the last digits of a force.
TEST(Refine, SplitsAsOpenMeshDoes) {
  using Base = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeMeshTraits>;
  Random random(7);
  for (const bool with_holes : {false, true}) {
    TriangleSoup sheet;
    for (std::uint32_t i = 0; i < 64; ++i)
      sheet.vertices.emplace_back(i / 8 + random.uniform(-0.3, 0.3), i % 8, random.uniform(-0.3, 0.3));
    for (std::uint32_t i = 0; i < 55; ++i) {
      if (i % 8 == 7 || (with_holes && i % 5 == 0)) continue;
      sheet.triangles.push_back({i, i + 8, i + 1});
      sheet.triangles.push_back({i + 1, i + 8, i + 9});
    }
    HalfEdgeMesh ours = mesh_from_triangles(sheet).mesh;
    Base known = ours;
    refine(ours, 0.15);
    OpenMesh::Subdivider::Uniform::LongestEdgeT<Base, double> subdivider;
    subdivider.set_max_edge_length(0.15);
    subdivider(known, 1);
    ASSERT_EQ(ours.n_halfedges(), known.n_halfedges());
    for (const auto v : known.vertices())
      EXPECT_TRUE(ours.point(v) == known.point(v) && ours.halfedge_handle(v) == known.halfedge_handle(v));
    for (const auto f : known.faces()) EXPECT_EQ(ours.halfedge_handle(f), known.halfedge_handle(f));
    for (const auto h : known.halfedges()) {
      EXPECT_EQ(ours.next_halfedge_handle(h), known.next_halfedge_handle(h));
      EXPECT_EQ(ours.prev_halfedge_handle(h), known.prev_halfedge_handle(h));
      EXPECT_EQ(ours.to_vertex_handle(h), known.to_vertex_handle(h));
      EXPECT_EQ(ours.face_handle(h), known.face_handle(h));
    }
  }
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
  double widest = 0.0;  // largest radius of the circumscribed circles of the facets
  for (const auto face : mesh.faces()) {
    double product = 1.0;
    for (auto edge = mesh.cfe_iter(face); edge.is_valid(); ++edge) product *= mesh.calc_edge_length(*edge);
    widest = std::max(widest, product / (4.0 * mesh.calc_face_area(face)));
  }
  refine(mesh, 0.0002);
  const auto points = vertices_with_normals(mesh);
  ASSERT_GT(points.size(), 5000u);
  // A facet's normal is the sphere's normal at the centre of the facet's circumscribed circle. Let r be the radius of
  // this circle and R the radius of the sphere. The angle between the facet's normal and the sphere's normal at any
  // point of the facet is at most asin(r / R). The mean of normals within a cone lies in the cone too.
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

TEST(Subsampled, KeepsTheMostCentralPointOfEachCubeAndDirection) {
  HalfEdgeMesh mesh = mesh_from_triangles(test::sphere(1.0, 4)).mesh;
  const auto points = vertices_with_normals(mesh);
  const double spacing = 0.25;
  const auto thin = subsampled(points, spacing);
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
  EXPECT_EQ(subsampled(thin, spacing).size(), thin.size());
}

}  // namespace
}  // namespace hapbench::half_edge_mesh_test
