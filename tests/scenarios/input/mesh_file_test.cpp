#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/mesh_sampling.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
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

  std::string refusal_of(const std::string& name, const std::string& text) const {
    const auto refusal = test::input_error_of([&] { read(name, text); });
    EXPECT_TRUE(refusal) << name << " was not refused";
    return refusal ? refusal->what() : "";
  }

  /// Reads a mesh that causes one warning, and returns the text of the warning after the file's name. The name has no
  /// directory.
  std::string warning_of(const std::string& name, const std::string& text) const {
    const auto warnings = read(name, text).warnings;
    EXPECT_EQ(warnings.size(), 1u);
    return warnings.empty() ? "" : warnings[0].substr(name.size());
  }

  test::TemporaryDirectory directory_;
};

/// Returns the positions sorted, because some formats do not keep the order.
std::vector<Vec3> sorted_positions(const std::vector<SurfacePoint>& points) {
  std::vector<Vec3> positions;
  for (const SurfacePoint& p : points) positions.push_back(p.position);
  std::sort(positions.begin(), positions.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return positions;
}

TEST_F(MeshFile, IsReadFromEveryFormatAndEncoding) {
  // Use coordinates that single precision represents exactly, so that every file has the same coordinates.
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
    if (name.ends_with(".stl")) continue;  // STL files list the vertices in the order of their triangles
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
      {"continued.obj",
       "v 0 \\\n 0 0\nv 1 \\\n0 \\\n0\n#no \\\nv 0 1 0 \\ \n\nv 0 0 1\n"
       "f 1 3 \\\n2\nf 1 \\\r\n 2 \\\r\n4\nf 1 4 3\nf 2 3 4\n"},
      {"glued.off", "OFF4 4 6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"glued_colours.off", "coff4 4\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"no_keyword.off", "4 4 6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"counts_in_lines.off", "OFF\n4 # vertices\n\n4\n6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"counts_in_two_lines.off", "OFF 4\n4 6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"edges_in_a_line.off", "OFF\n4 4\n6\n" + tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
      {"faces_first.ply",
       "ply\nformat ascii 1.0\n\nelement face 4\nproperty list uchar int vertex_indices\nelement vertex 4\nproperty "
       "float x\nproperty float y\nproperty float z\nend_header\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n" +
           tetrahedron},
      {"lines.stl",
       "solid outer loop of a facet\nfacet normal nan nan nan outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 "
       "endloop endfacet\nfacet normal 0 0 0 outer loop\nvertex 0 0 0 vertex 1 0 0\nvertex 0 0 1 255 0 0 endloop "
       "endfacet "
       "facet\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0 endloop\nendfacet\nendsolid outer\n"
       "solid\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
       "endsolid facet\n"},
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
       "outer loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nEndSolid outer part"},
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

/// Checks a file with lists and other properties before, between and after the properties of the surface.
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
    add(static_cast<std::uint8_t>(x));  // number of tags that follow
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

/// Returns the surface in each text format, with file names.
std::vector<test::NamedText> text_formats(const TriangleSoup& soup) {
  return {{"m.obj", test::obj_text(soup)},
          {"m.off", test::off_text(soup)},
          {"m.ply", test::ply_text(soup)},
          {"m.stl", test::stl_text(soup)}};
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

TEST_F(MeshFile, IsReadWithAByteOrderMarkAndAnyLineEnds) {
  for (const auto& [name, text] : text_formats(test::cube())) {
    const auto expected = sorted_positions(read(name, text).points);
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
        SCOPED_TRACE(testing::Message() << name << mark.size() << end.size() << int(end[0]));
        const MeshPoints mesh = read(name, mark + replaced(replaced(text, "\n", end), " ", "\t"));
        EXPECT_EQ(sorted_positions(mesh.points), expected);
        EXPECT_TRUE(mesh.warnings.empty());
      }
    }
  }
  // Check a header with CR line ends before binary data that begins with LF.
  std::string binary = test::binary_ply_text(test::cube(), true, false);
  const std::size_t data = binary.find("end_header\n") + 11;
  binary[data] = '\n';
  const auto expected = sorted_positions(read("lf.ply", binary).points);
  EXPECT_EQ(sorted_positions(read("cr.ply", replaced(binary.substr(0, data), "\n", "\r") + binary.substr(data)).points),
            expected);
  EXPECT_EQ(
      sorted_positions(read("crlf.ply", replaced(binary.substr(0, data), "\n", "\r\n") + binary.substr(data)).points),
      expected);
  // Check files in another encoding and compressed files.
  for (const std::string& start : {std::string("\xFF\xFEv\0", 4), std::string("\xFE\xFF\0v", 4)})
    EXPECT_NE(refusal_of("utf16.obj", start + " 0 0 0\n").find("is a text in UTF-16 or UTF-32; allowed: UTF-8"),
              std::string::npos);
  EXPECT_NE(refusal_of("packed.stl", "\x1F\x8B\x08").find("is compressed"), std::string::npos);
}

/// Returns an L-shaped prism, 2 units high, in each text format, with polygons instead of triangles.
std::vector<test::NamedText> l_prisms(const std::string& face = "5 4 3 2 1 0") {
  const std::vector<std::string> faces = {face,      "6 7 8 9 10 11", "0 1 7 6",   "1 2 8 7",
                                          "2 3 9 8", "3 4 10 9",      "4 5 11 10", "5 0 6 11"};
  std::string vertices, obj, counted;
  for (const char* z : {"0", "2"})
    for (const char* xy : {"6 2", "6 4", "0 4", "0 0", "3 0", "3 2"}) {
      vertices += fmt::format("{} {}\n", xy, z);
      obj += fmt::format("v {} {}\n", xy, z);
    }
  for (const std::string& corners : faces) {
    const Words words = words_of(corners);
    counted += fmt::format("{} {}\n", words.size(), corners);
    obj += "f";
    for (const std::string_view word : words) obj += fmt::format(" {}", *whole_number(word) + 1);
    obj += "\n";
  }
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\nelement face 8\n"
      "property list uchar int vertex_indices\nend_header\n";
  return {{"l.obj", obj}, {"l.off", "OFF\n12 8 0\n" + vertices + counted}, {"l.ply", header + vertices + counted}};
}

TEST_F(MeshFile, MayHavePolygonsWithReflexCorners) {
  for (const auto& [name, text] : l_prisms()) {
    SCOPED_TRACE(name);
    const hapbench::MeshFile mesh(text, name, {});
    EXPECT_TRUE(mesh.is_closed());
    EXPECT_TRUE(mesh.warnings(name).empty());
    const TriangleSoup soup = mesh.triangles();
    double area = 0.0, volume = 0.0;
    for (const auto& [i, j, k] : soup.triangles) {
      const Vec3 &a = soup.vertices[i], &b = soup.vertices[j], &c = soup.vertices[k];
      area += 0.5 * (b - a).cross(c - a).norm();
      volume += a.dot(b.cross(c)) / 6.0;
    }
    EXPECT_NEAR(volume, 18.0 * 2.0, 1e-12);
    EXPECT_NEAR(area, 2.0 * 18.0 + 20.0 * 2.0, 1e-12);
  }
}

TEST_F(MeshFile, NamesAPolygonThatCrossesItself) {
  const std::map<std::string, std::string> places = {{"l.obj", "l.obj, line 13: face 1: "},
                                                     {"l.off", "l.off, line 15: face 0: "},
                                                     {"l.ply", "l.ply, line 22: face 0: "}};
  for (const auto& [name, text] : l_prisms("5 3 4 2 1 0")) {
    const std::string refusal = refusal_of(name, text);
    EXPECT_NE(refusal.find(places.at(name) + "crosses itself: the edge between its corners"), std::string::npos)
        << refusal;
  }
  EXPECT_NE(refusal_of("bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\n\nf 1 2 3 4\n")
                .find("bent.obj, line 6: face 1: is not planar: a corner is off its plane by 1"),
            std::string::npos);
  const auto warnings = read("uneven.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n\nf 1 2 3 4\n").warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(
      warnings[0],
      "uneven.obj: polygons that are not planar: 1, the first in line 6; the largest is off its plane by 7.9 % of its "
      "diameter; other divisions into triangles are possible");
  EXPECT_EQ(warnings[1].find("uneven.obj: the mesh is open"), 0u);
}

TEST_F(MeshFile, NamesVerticesAsTheFileCountsThem) {
  EXPECT_NE(refusal_of("a.obj", "# x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 \\\n 4\n")
                .find("a.obj, line 6: face 2: got vertex 4; allowed: 1 ... 3, the vertices of the file"),
            std::string::npos);
  EXPECT_NE(refusal_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")
                .find("a.off, line 6: face 0: got vertex 3; allowed: 0 ... 2, the vertices of the file"),
            std::string::npos);
  EXPECT_NE(refusal_of("far.obj", "v 0 0 0\nv 1 0 0\nv 0 2000 0\nf 1 2 3\n").find("far.obj, line 3: vertex 3: got"),
            std::string::npos);
}

/// Checks every truncated text: it is either rejected, or accepted as an open mesh with a warning.
TEST_F(MeshFile, IsRefusedOrNamedIfItsFileIsCut) {
  for (const auto& [name, text] : text_formats(test::cube())) {
    // Cutting the last line end, or the name after endsolid, loses nothing.
    const std::size_t whole = name == "m.stl" ? text.rfind("endsolid") + 8 : text.size() - 1;
    for (std::size_t size = 1; size < whole; ++size) {
      SCOPED_TRACE(testing::Message() << name << " after " << size << " bytes");
      const std::string cut = text.substr(0, size);
      try {
        const hapbench::MeshFile mesh(cut, name, {});
        EXPECT_EQ(name, "m.obj");
        EXPECT_FALSE(mesh.is_closed());
        EXPECT_FALSE(mesh.warnings(name).empty());
      } catch (const InputError&) {
      }
    }
  }
  for (const auto& [name, text] : test::mesh_texts(test::cube())) {
    if (!name.ends_with("ly") && !name.starts_with("bin")) continue;
    const std::string refusal = refusal_of(name, text.substr(0, text.size() - 7));
    EXPECT_NE(refusal.find("cut short"), std::string::npos) << refusal;
  }
  EXPECT_NE(refusal_of("m.stl", test::stl_text(test::cube()).substr(0, 500)).find("is it cut short"),
            std::string::npos);
  const std::string facets = replaced(test::stl_text(test::cube()), "endsolid thing\n", "");
  EXPECT_NE(refusal_of("m.stl", facets).find("the file is cut short: it ends after 12 triangles and \"endfacet\""),
            std::string::npos);
  EXPECT_NE(refusal_of("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6")
                .find("line 8: the file is cut short"),
            std::string::npos);
  EXPECT_NE(refusal_of("s.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1 2/2 3/").find("is it cut short"), std::string::npos);
}

TEST_F(MeshFile, WarnsAboutWhatItsReaderIgnores) {
  const TriangleSoup cube = test::cube();
  EXPECT_EQ(warning_of("lines.obj", test::obj_text(cube) + "l 1 2\nl 2 3\nusemtl x\n"),
            ": statements other than polygons, \"l\", which were ignored: 2, the first is line 23");
  EXPECT_EQ(warning_of("other.obj", "call part.obj 1\n" + test::obj_text(cube)),
            ": statements other than polygons, \"call\", which were ignored: 1, the first is line 1");
  EXPECT_EQ(warning_of("unknown.obj", "x 1\n" + test::obj_text(cube)),
            ": unknown statements \"x\", which were ignored: 1, the first is line 1");
  EXPECT_EQ(warning_of("long.off", test::off_text(cube) + "\n3 0 1 2\n3 0 1 2\n"),
            ": lines after the last entry that the header declares, which were ignored: 2, the first is line 24");
  EXPECT_EQ(warning_of("long.ply", test::ply_text(cube) + "3 0 1 2\n"),
            ": lines after the last entry that the header declares, which were ignored: 1, the first is line 30");
  EXPECT_EQ(warning_of("long_binary.ply", test::binary_ply_text(cube, true, true) + "more"),
            ": bytes after the last entry that the header declares, which were ignored: 4");
  EXPECT_EQ(warning_of("long.stl", test::binary_stl_text(cube) + "more"),
            ": bytes after the 12 triangles that the header declares, which were ignored: 4");
  EXPECT_EQ(warning_of("more.stl", test::binary_stl_text(cube) + std::string(100, '\0')),
            ": bytes after the 12 triangles that the header declares, which were ignored: 100, the size of 2 more "
            "triangles; is the header wrong?");
}

TEST_F(MeshFile, WarnsAboutTextAfterCoordinates) {
  const TriangleSoup cube = test::cube();
  /// Returns a text with `rest` appended to the line with this number.
  const auto with = [](std::string text, int line, const std::string& rest) {
    std::size_t end = text.find('\n');
    while (--line > 0) end = text.find('\n', end + 1);
    return text.insert(end, rest);
  };
  const std::string warned = ": lines with other text after the coordinates of a vertex, which was ignored: 1, the ";
  EXPECT_EQ(warning_of("mm.obj", with(test::obj_text(cube), 3, " mm")), warned + "first is line 3: \"mm\"");
  EXPECT_EQ(warning_of("eight.obj", with(test::obj_text(cube), 3, " 1 0 0 1 9")), warned + "first is line 3: \"9\"");
  EXPECT_EQ(warning_of("mm.off", with(test::off_text(cube), 3, " mm")), warned + "first is line 3: \"mm\"");
  EXPECT_EQ(warning_of("mm.stl", with(test::stl_text(cube), 4, " mm")), warned + "first is line 4: \"mm\"");
  // A weight, a colour and a normal are numbers.
  EXPECT_TRUE(read("colour.obj", with(test::obj_text(cube), 3, " 1 0 0")).warnings.empty());
  EXPECT_TRUE(read("weight.obj", with(test::obj_text(cube), 3, " 1 1 0 0")).warnings.empty());
  EXPECT_TRUE(read("normal.off", with(test::off_text(cube), 3, " 0 0 1")).warnings.empty());
}

TEST_F(MeshFile, IsReadFromAnStlOfOneLine) {
  std::string text = test::stl_text(test::cube());
  std::ranges::replace(text, '\n', ' ');
  const MeshPoints mesh = read("one_line.stl", text);
  EXPECT_EQ(sorted_positions(mesh.points), sorted_positions(read("cube.stl", test::stl_text(test::cube())).points));
  EXPECT_TRUE(mesh.warnings.empty());
}

TEST_F(MeshFile, KeepsOneOfSeveralEqualFaces) {
  const TriangleSoup cube = test::cube();
  TriangleSoup twice = cube, sheet = cube;
  for (const auto& [a, b, c] : cube.triangles) twice.triangles.push_back({c, b, a});
  const MeshPoints one = read("one.obj", test::obj_text(cube)), two = read("two.obj", test::obj_text(twice));
  ASSERT_EQ(two.points.size(), one.points.size());
  for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(two.points[i].normal, one.points[i].normal);
  ASSERT_EQ(two.warnings.size(), 1u);
  EXPECT_EQ(
      two.warnings[0],
      "two.obj: every face is double: each triangle is listed with both windings, and only the first copy was kept: 12 "
      "triangles");
  sheet.triangles = {{0, 1, 2}, {2, 1, 0}, {1, 3, 2}, {2, 3, 1}};
  const auto warnings = read("sheet.off", test::off_text(sheet)).warnings;
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_EQ(warnings[1].find("sheet.off: a double-sided sheet: each triangle is listed with both windings"), 0u);
  twice = cube;
  twice.triangles.push_back(cube.triangles[3]);
  EXPECT_EQ(warning_of("same.ply", test::ply_text(twice)), ": faces left out because they repeat an earlier face: 1");
  std::swap(twice.triangles.back()[0], twice.triangles.back()[1]);
  EXPECT_EQ(warning_of("opposite.ply", test::ply_text(twice)),
            ": faces left out because they repeat an earlier face with opposite winding: 1");
}

/// Checks a double-sided sheet: the two sides of a plane quadrilateral. The readers divide the two sides along
/// different diagonals. The corners are rounded to six digits, so that the sides enclose a small volume. Each side has
/// its own vertices.
TEST_F(MeshFile, NamesASheetWhoseSidesAreDividedDifferently) {
  const std::string corners = "0.123456 0 0\n1.123456 0.3 0.7\n0.423456 1.3 0.912346\n-0.576544 1 0.212346\n";
  std::string vertices = "v " + corners;
  for (std::size_t at = 2; (at = vertices.find('\n', at)) + 1 < vertices.size(); at += 3) vertices.insert(at + 1, "v ");
  const std::string says =
      ": double-sided sheets, which are closed components without volume: 1, the largest 4 triangles";
  for (const auto& [name, text] :
       {std::pair(std::string("sheet.obj"), vertices + vertices + "f 1 2 3 4\nf 8 7 6 5\n"),
        {"sheet.off", "OFF 8 2 0\n" + corners + corners + "4 0 1 2 3\n4 7 6 5 4\n"},
        {"sheet.ply",
         "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
             corners + corners + "4 0 1 2 3\n4 7 6 5 4\n"}}) {
    EXPECT_EQ(warning_of(name, text).find(says), 0u) << warning_of(name, text);
    EXPECT_TRUE(hapbench::MeshFile(text, name, {}).findings().components[0].is_flat);
  }
  // A thin plate and a thin wire have a volume, so they cause no warning.
  for (const Vec3& size : {Vec3(1, 1, 1e-4), Vec3(1, 1e-3, 1e-3)}) {
    TriangleSoup thin = test::cube();
    for (Vec3& vertex : thin.vertices) vertex = vertex.cwiseProduct(size);
    EXPECT_TRUE(read("thin.obj", test::obj_text(thin)).warnings.empty()) << size.transpose();
  }
}

TEST_F(MeshFile, NamesVerticesThatNoFaceUses) {
  EXPECT_EQ(warning_of("spare.obj", test::obj_text(test::cube()) + "v 8 8 8\n"),
            ": vertices that no face uses, which were ignored: 1, the first is vertex 9 in line 23");
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n";
  const auto warnings = read("cut.obj", triangle).warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0],
            "cut.obj: vertices that no face uses, which were ignored: 1, the first is vertex 4 in line 4; the mesh is "
            "open: is the file cut short?");
}

/// Checks that a file of another format, or with numbers in another notation, gives an error that names the problem.
TEST_F(MeshFile, IsRefusedByWhatItIs) {
  for (
      const auto& [name, text, says] :
      {std::tuple("off.obj", std::string("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                  "off.obj, line 1: got \"OFF\", and the file has no faces; allowed: statements of OBJ"),
       {"not_finite.obj", "v 0 0 0\nv 1 0 -1.#IND\nv 0 1 0\nf 1 2 3\n",
        "not_finite.obj, line 2: got \"-1.#IND\"; allowed: a finite number"},
       {"not_finite.off", "OFF\n3 1 0\n0 0 0\n1 0 1.#QNAN # point\n0 1 0\n3 0 1 2\n",
        "not_finite.off, line 4: got \"1.#QNAN\"; allowed"},
       {"folder.obj", "v 0 0 0\nmtllib C:\\parts\\\nv 1 0 0\nv 0 1 0\nv 2 2 0\nf 1 2 3\n",
        "folder.obj, line 2: got \"mtllib\" with a backslash at its end, which joins the next line, \"v\", to it"},
       {"fortran.obj", "v 0 0 0\nv 1.0D+00 0 0\nv 0 1 0\nf 1 2 3\n",
        "fortran.obj, line 2: got \"1.0D+00\"; allowed: a finite number; write an exponent as in 1e-3"},
       {"many.off", "nOFF\n3\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "many.off, line 1: got \"nOFF\", whose vertices do not have three coordinates; allowed: OFF"},
       {"four.off", "C4OFF\n3 1 0\n", "four.off, line 1: got \"C4OFF\""},
       {"one_line.off", "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2\n",
        "one_line.off, line 1: got 14 values after the counts of vertices and faces; allowed: the number of edges, and "
        "then each vertex and each face in a line of its own"},
       {"twice.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "1\nproperty list uchar int vertex_indices\nelement face 1\n",
        "twice.ply, line 9: the element \"face\" is declared twice; allowed: once"},
       {"no_loop.stl", "solid\nfacet normal 0 0 1\nendfacet\nendsolid\n",
        "no_loop.stl, line 3: got endfacet after \"facet\"; allowed: \"outer loop\" and three vertices"},
       {"four.stl",
        "solid\nfacet\nouter loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0\nvertex 1 1 0\nendloop endfacet\nendsolid\n",
        "four.stl, line 4: got \"vertex\"; allowed: three times vertex after each \"outer loop\""},
       {"upper.obj", "V 0 0 0\nV 1 0 0\nV 0 1 0\nF 1 2 3\n", "upper.obj, line 1: got \"V\", and the file has no faces"},
       {"page.stl", "<!DOCTYPE html>\n<html><body>" + std::string(200, 'x') + "</body></html>\n",
        "page.stl, line 1: is not an STL file: it begins with \"<!DOCTYPE html>\"; allowed"},
       {"pointer.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
        "it begins with \"version https://git-lfs.github.com/spec/\""},
       {"none.stl", std::string(84, '\0') + std::string(600, '\1'),
        "its header declares 0 triangles, and 600 bytes follow"},
       {"comma.obj", "v 0 0 0\nv 1,5 0 0\n",
        "comma.obj, line 2: got \"1,5\" with a decimal comma; allowed: a number with"},
       {"comma.off", "OFF 3 1 0\n0 0 0\n1 0 0,25\n", "comma.off, line 3: got \"0,25\" with a decimal comma"},
       {"comma.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0,1 0 0\n",
        "comma.stl, line 4: got \"0,1\" with a decimal comma"}})
    EXPECT_NE(refusal_of(name, text).find(says), std::string::npos) << refusal_of(name, text);
}

TEST_F(MeshFile, NamesSpecks) {
  const TriangleSoup two = test::together(test::cube(0.01, {5, 0, 0}), test::cube());
  EXPECT_EQ(warning_of("speck.obj", test::obj_text(two)),
            ": specks, which are components smaller than 5 % of the largest: 1 of 2 components, the largest of them 12 "
            "triangles, 20 x 20 x 20 mm at (5e+03, 0, 0) mm; remove specks in a mesh editor");
  const hapbench::MeshFile mesh(test::obj_text(two), "speck.obj", {});
  ASSERT_EQ(mesh.findings().components.size(), 2u);
  EXPECT_EQ(mesh.findings().components[0].box.max, Vec3(1, 1, 1));
  EXPECT_TRUE(mesh.findings().components[0].is_closed);
  EXPECT_EQ(components_above_speck_size(mesh.findings()), 1u);
  EXPECT_EQ(sorted_positions(mesh.largest_component().points()),
            sorted_positions(read("cube.obj", test::obj_text(test::cube())).points));
}

TEST_F(MeshFile, WarnsOnceAboutWhatIsOdd) {
  const TriangleSoup cube = test::cube();
  TriangleSoup odd = cube;
  odd.triangles.pop_back();
  EXPECT_EQ(
      warning_of("open.obj", test::obj_text(odd)),
      ": the mesh is open: 3 boundary edges, within x 1e+03 ... 1e+03, y -1e+03 ... 0, z 0 ... 1e+03 mm; the surface "
      "ends there");
  odd = cube;
  std::swap(odd.triangles[4][0], odd.triangles[4][1]);
  EXPECT_EQ(warning_of("wound.off", test::off_text(odd)),
            ": faces reversed because they were wound against most faces of their component: 1");
  EXPECT_EQ(warning_of("inside_out.ply", test::ply_text(test::reversed(cube))),
            ": closed components reversed because their normals pointed to the wrong side: 1");
  EXPECT_EQ(warning_of("touching.obj", test::obj_text(test::together(cube, test::cube(1.0, {2, 2, 0})))),
            ": the surface is cut along edges with more than two faces: 1, the first at (1e+03, 1e+03, 0) mm");
  odd = cube;
  odd.triangles.push_back({0, 1, 1});
  EXPECT_EQ(warning_of("degenerate.off", test::off_text(odd)),
            ": faces left out because two of their corners are equal: 1");
}

/// Vertices that a program rounded in each triangle differ by nanometres: nothing is joined, and the warning names the
/// cause. The boundary of a surface that is really open has no such partner.
TEST_F(MeshFile, NamesVerticesThatDifferInTheLastDigits) {
  const TriangleSoup cube = test::cube();
  TriangleSoup loose;
  for (const auto& corners : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    const double error = 1e-8 * static_cast<double>(first % 7);
    for (const std::uint32_t corner : corners)
      loose.vertices.emplace_back(cube.vertices[corner] + Vec3::Constant(error));
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  const auto warnings = read("loose.obj", test::obj_text(loose)).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("their vertices differ only in the last digits and are not joined: merge such vertices"),
            std::string::npos)
      << warnings[0];
}

TEST_F(MeshFile, IsResampledToTheSpacing) {
  const std::string text = test::stl_text(test::cube(5.0));
  const double spacing = 0.0005;
  const MeshPoints mesh = read("cube.stl", text, {0.001, spacing});
  // The cube has six sides with 20 x 20 cells, and half cells at the edges: 21 x 21 at most. Nearly each cell has a
  // point.
  EXPECT_LE(mesh.points.size(), 6u * 21 * 21);
  EXPECT_GE(mesh.points.size(), 6u * 20 * 20 * 9 / 10);
  for (const SurfacePoint& p : mesh.points) {
    EXPECT_NEAR(p.position.cwiseAbs().maxCoeff(), 0.005, 1e-18) << "on the surface";
    // There are no gaps: the next point is in the same or a neighbouring cell, or was removed from one of these cells.
    const auto near = std::count_if(mesh.points.begin(), mesh.points.end(), [&](const SurfacePoint& q) {
      return (q.position - p.position).cwiseAbs().maxCoeff() <= 2 * spacing;
    });
    EXPECT_GE(near, 4);
  }
}

}  // namespace
}  // namespace hapbench::mesh_file_test
