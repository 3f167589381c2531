#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/mesh_sampling.hpp"
#include "scenarios/input/text_file.hpp"
#include "sim/mesh/half_edge_mesh.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::mesh_file_test {
namespace {

namespace fs = std::filesystem;

struct MeshPoints {
  std::vector<SurfacePoint> points;
  std::vector<std::string> warnings;
};

class MeshFile : public testing::Test {
 protected:
  MeshPoints read(const std::string& name, const std::string& text, const MeshSampling& sampling = {}) const {
    test::write_plainly(directory_ / name, text);
    const hapbench::MeshFile mesh(read_named_file(directory_ / name), directory_ / name, sampling);
    return {mesh.points(), mesh.warnings(directory_ / name)};
  }

  /// The one warning behind the file's name, which has no directory in front.
  std::string warning_of(const std::string& name, const std::string& text) const {
    const auto warnings = read(name, text).warnings;
    EXPECT_EQ(warnings.size(), 1u);
    return warnings.empty() ? "" : warnings[0].substr(name.size());
  }

  test::TemporaryDirectory directory_;
};

/// Sorted, because some formats do not keep the order.
std::vector<Vec3> sorted_positions(const std::vector<SurfacePoint>& points) {
  std::vector<Vec3> positions;
  for (const SurfacePoint& p : points) positions.push_back(p.position);
  std::sort(positions.begin(), positions.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return positions;
}

TEST_F(MeshFile, IsReadFromEveryFormatAndEncoding) {
  // Coordinates that single precision holds, so that every file holds the same.
  TriangleSoup soup = test::sphere(1.0, 2);
  for (Vec3& v : soup.vertices) v = (1024.0 * v).array().round() / 1024.0;
  const auto expected = vertices_with_normals(mesh_from_triangles(soup).mesh);
  for (const auto& [name, text] : test::mesh_texts(soup)) {
    SCOPED_TRACE(name);
    const MeshPoints mesh = read(name, text);
    EXPECT_TRUE(mesh.warnings.empty());
    ASSERT_EQ(mesh.points.size(), 66u);
    EXPECT_EQ(sorted_positions(mesh.points), sorted_positions(expected));
    for (const SurfacePoint& p : mesh.points) {
      EXPECT_GT(p.normal.dot(p.position), 0.9);
      EXPECT_NEAR(p.normal.norm(), 1.0, 1e-15);
    }
    if (name.ends_with(".stl")) continue;  // a soup in the order of its triangles
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(mesh.points[i].normal, expected[i].normal);
  }
}

TEST_F(MeshFile, IsReadInThePrecisionItIsWrittenIn) {
  TriangleSoup soup = test::cube();
  for (Vec3& v : soup.vertices) v *= 1.0 / 3.0;
  for (const auto& [name, text] : test::mesh_texts(soup)) {
    const bool single = name.starts_with("binary") || name.find("float") != std::string::npos;
    const double third = single ? static_cast<double>(1.0f / 3.0f) : 1.0 / 3.0;
    for (const SurfacePoint& p : read(name, text, {0.001, {}}).points) {
      for (const double c : p.position) EXPECT_EQ(std::abs(c), 0.001 * third) << name;
    }
  }
}

TEST_F(MeshFile, IsReadWhateverElseItsTextHolds) {
  const std::string tetrahedron = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::vector<test::NamedText> texts = {
      {"a.obj",
       "mtllib none.mtl\r\nv 0 0 0 1\r\nv 1 0 0\r\n\tv +0 1e0 -0.0 # comment\r\nv 0 0 1\r\nvt 0 0\r\nvn 0 0 "
       "1\r\nusemtl x\r\n"
       "f 1//1 3//1 2//1\r\nf 1/1 2/1 4/1\r\nf -4/1/1 -1/1/1 -2/1/1\r\nf 2 3 4"},
      {"colours.obj",
       "\n# colours behind positions, quadrilaterals none\nv 0 0 0 .1 .2 .3\nv 1 0 0 .1 .2 .3\nv 0 1 0 .1 .2 .3\nv 0 0 "
       "1 "
       ".1 .2 .3\ng a\ns off\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4 # last\n"},
      {"counts_in_header.off", "OFF 4 4 6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3"},
      {"comments.off",
       "OFF # header\n# nothing\n\n4 4\n" + tetrahedron + "3 0 2 1 255 0 0\n\n3 0 1 3 # face\n3 0 3 2 1\n3 1 2 3\n"},
      {"comments_first.off",
       "# written by a program\r\n\r\nOFF\r\n# counts\r\n4 4 0\r\n\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n0 0 1\r\n3 0 2 1\r\n3 "
       "0 "
       "1 3\r\n3 0 3 2\r\n3 1 2 3\r\n"},
      {"colours.off",
       "COFF\n4 4 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n0 0 1 255 0 0 255\n3 0 2 1\n3 0 1 3\n3 0 "
       "3 2\n3 1 2 3\n"},
      {"normals.off",
       "NOFF\n4 4 0\n0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 1 0 0\n0 0 1 1 0 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"Capitals.STL",
       "SOLID outer part\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 0 1E0 0\nVERTEX 1 0 "
       "0\nENDLOOP\nENDFACET\n"
       " facet normal 0 0 0\n  Outer loop\n   vertex 0 0 0\n\n   vertex 1 0 0\n   vertex 0 0 1\n  endloop\n endfacet\n"
       "outer loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\n"
       "outer loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\n"},
      {"more.ply",
       "ply\nformat ascii 1.0\ncomment x\nelement sensor 1\nproperty int id\nelement vertex 4\nproperty uchar red\n"
       "property float32 z\nproperty float64 x\nproperty float y\nelement face 4\nproperty list uint8 uint "
       "vertex_index\n"
       "property uchar flag\nelement edge 1\nproperty list uchar int whatever\nend_header\n"
       "7\n9 0 0 0\n9 0 1 0\n9 0 0 1\n9 1 0 0\n3 0 2 1 5\n3 0 1 3 5\n3 0 3 2 5\n3 1 2 3 5\n1 1"},
      {"lists.ply",
       "ply\r\nformat ascii 1.0\r\nobj_info none\r\nelement strip 1\r\nproperty list int int indices\r\nelement "
       "vertex 4\r\nproperty list uchar uchar tags\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
       "property float nx\r\nelement nothing 9\r\nelement face 4\r\nproperty list uchar float texcoord\r\nproperty "
       "uchar flag\r\nproperty list uchar uint8 vertex_indices\r\nproperty list uchar float more\r\nend_header\r\n"
       "2 7 8\r\n2 1 2 0 0 0 nan\r\n0 1 0 0 0\r\n0 0 1 0 0\r\n0 0 0 1 0\r\n"
       "1 .5 0 3 0 2 1 0\r\n0 0 3 0 1 3 0\r\n0 0 3 0 3 2 0\r\n0 0 3 1 2 3 0\r\n"}};
  for (const auto& [name, text] : texts) {
    SCOPED_TRACE(name);
    const MeshPoints mesh = read(name, text);
    EXPECT_TRUE(mesh.warnings.empty());
    EXPECT_EQ(sorted_positions(mesh.points), (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
  }
}

/// Lists and other properties before, between and behind what makes the surface.
TEST_F(MeshFile, IsReadFromABinaryPlyWithMoreInIt) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement strip 1\nproperty list ushort short indices\nelement nothing 3\n"
      "element vertex 4\nproperty uchar red\nproperty float z\nproperty list uchar double tags\nproperty double x\n"
      "property float y\nelement face 4\nproperty list uchar float texcoord\nproperty list int ushort vertex_index\n"
      "property char flag\nelement edge 1\nproperty int cut_off\nend_header\n";
  const auto add = [&text](auto value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(std::uint16_t{2});
  for (const std::int16_t index : {std::int16_t{-1}, std::int16_t{-2}}) add(index);
  for (const auto& [x, y, z] : std::vector<std::array<double, 3>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    add(std::uint8_t{200});
    add(static_cast<float>(z));
    add(static_cast<std::uint8_t>(x));  // as many tags
    if (x > 0.0) add(7.0);
    add(x);
    add(static_cast<float>(y));
  }
  for (const auto& corners : std::vector<std::array<std::uint16_t, 3>>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    add(std::uint8_t{1});
    add(0.5f);
    add(std::int32_t{3});
    for (const std::uint16_t corner : corners) add(corner);
    add(std::int8_t{-1});
  }
  const MeshPoints mesh = read("more.ply", text);
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_EQ(sorted_positions(mesh.points), (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
}

TEST_F(MeshFile, IsReadFromABinaryStlWhateverItsHeaderAndEnd) {
  const std::string text = test::binary_stl_text(test::cube());
  EXPECT_EQ(read("solid.stl", text).points.size(), 8u);
  EXPECT_EQ(read("longer.stl", text + "more").points.size(), 8u);
  EXPECT_EQ(read("other.stl", std::string(80, 'x') + text.substr(80)).points.size(), 8u);
  EXPECT_EQ(read("spaces.stl", "solid" + std::string(75, ' ') + text.substr(80)).points.size(), 8u);
}

TEST_F(MeshFile, WarnsOnceAboutWhatIsOdd) {
  const TriangleSoup cube = test::cube();
  TriangleSoup odd = cube;
  odd.triangles.pop_back();
  EXPECT_EQ(
      warning_of("open.obj", test::obj_text(odd)),
      ": the mesh is open: 3 boundary edges, within x 1e+03 ... 1e+03, y -1e+03 ... 0, z 0 ... 1e+03 mm; beyond them "
      "there is nothing to touch");
  odd = cube;
  std::swap(odd.triangles[4][0], odd.triangles[4][1]);
  EXPECT_EQ(warning_of("wound.off", test::off_text(odd)),
            ": faces turned, which were wound against their neighbours: 1");
  EXPECT_EQ(warning_of("inside_out.ply", test::ply_text(test::reversed(cube))),
            ": closed parts turned, which were inside out: 1");
  EXPECT_EQ(warning_of("touching.obj", test::obj_text(test::together(cube, test::cube(1.0, {2, 2, 0})))),
            ": the surface is cut along edges with more than two faces: 1, the first at (1e+03, 1e+03, 0) mm");
  odd = cube;
  odd.triangles.push_back({0, 1, 1});
  EXPECT_EQ(warning_of("degenerate.off", test::off_text(odd)),
            ": faces left out, two of their corners being the same: 1");
}

TEST_F(MeshFile, IsResampledToTheSpacing) {
  const std::string text = test::stl_text(test::cube(5.0));
  const double spacing = 0.0005;
  const MeshPoints mesh = read("cube.stl", text, {0.001, spacing});
  // Six sides of 20 x 20 cubes, with half ones at the edges: 21 x 21 at most, and a point in nearly each.
  EXPECT_LE(mesh.points.size(), 6u * 21 * 21);
  EXPECT_GE(mesh.points.size(), 6u * 20 * 20 * 9 / 10);
  for (const SurfacePoint& p : mesh.points) {
    EXPECT_NEAR(p.position.cwiseAbs().maxCoeff(), 0.005, 1e-18) << "on the surface";
    // No gaps: the next point is in the same or a neighbouring cube, or was thinned out from there.
    const auto near = std::count_if(mesh.points.begin(), mesh.points.end(), [&](const SurfacePoint& q) {
      return (q.position - p.position).cwiseAbs().maxCoeff() <= 2 * spacing;
    });
    EXPECT_GE(near, 4);
  }
}

}  // namespace
}  // namespace hapbench::mesh_file_test
