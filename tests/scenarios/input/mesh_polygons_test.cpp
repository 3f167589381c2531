#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"

namespace hapbench::mesh_polygons_test {
namespace {

/// Reads a mesh that causes one warning, and returns the text of the warning after the file's name.
std::string warning_of(const std::string& name, const std::string& text) {
  const auto warnings = MeshFile(text, name, {}).warnings(name);
  EXPECT_EQ(warnings.size(), 1u);
  return warnings.empty() ? "" : warnings[0].substr(name.size());
}

/// Returns the texts of a box of 6 x 5 x 3 whose faces are quadrilaterals, or polygons with more corners on their
/// edges. `faces` hold vertex numbers from 0; `more` are vertices after the eight corners of the box.
std::vector<test::NamedText> boxes(const std::vector<std::string>& faces, const std::vector<std::string>& more = {}) {
  std::vector<std::string> vertices = {"0 0 0", "6 0 0", "0 5 0", "6 5 0", "0 0 3", "6 0 3", "0 5 3", "6 5 3"};
  vertices.insert(vertices.end(), more.begin(), more.end());
  std::string plain, obj, counted;
  for (const std::string& vertex : vertices) {
    plain += vertex + "\n";
    obj += "v " + vertex + "\n";
  }
  for (const std::string& corners : faces) {
    const Words words = words_of(corners);
    counted += fmt::format("{} {}\n", words.size(), corners);
    obj += "f";
    for (const std::string_view word : words) obj += fmt::format(" {}", *whole_number(word) + 1);
    obj += "\n";
  }
  return {{"b.obj", obj},
          {"b.off", fmt::format("OFF\n{} {} 0\n{}{}", vertices.size(), faces.size(), plain, counted)},
          {"b.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                                "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
                                "end_header\n{}{}",
                                vertices.size(), faces.size(), plain, counted)}};
}

const std::vector<std::string> kQuadrilaterals = {"0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5"};

double volume_of(const MeshFile& mesh) {
  const TriangleSoup soup = mesh.triangles();
  double volume = 0.0;
  for (const auto& [i, j, k] : soup.triangles)
    volume += soup.vertices[i].dot(soup.vertices[j].cross(soup.vertices[k])) / 6.0;
  return volume;
}

/// Checks a polygon that is listed again, with either winding and from any corner: it is the same face.
TEST(MeshPolygons, KeepsOneOfSeveralEqualPolygons) {
  std::vector<std::string> twice = kQuadrilaterals;
  for (const std::string corners : {"1 3 2 0", "6 7 5 4", "4 5 1 0", "3 7 6 2", "2 6 4 0", "5 7 3 1"})
    twice.push_back(corners);
  for (const auto& [name, text] : boxes(twice)) {
    const MeshFile mesh(text, name, {});
    EXPECT_TRUE(mesh.is_closed()) << name;
    EXPECT_NEAR(volume_of(mesh), 90.0, 1e-12) << name;
    EXPECT_EQ(
        warning_of(name, text),
        ": every face is double: each triangle is listed with both windings, and only the first copy was kept: 12 "
        "triangles");
  }
  twice = kQuadrilaterals;
  twice.emplace_back("7 6 4 5");
  for (const auto& [name, text] : boxes(twice))
    EXPECT_EQ(warning_of(name, text), ": faces left out because they repeat an earlier face: 2");
}

/// Checks polygons with corners on their edges, such as a face whose neighbour is divided more finely. The mesh is
/// closed.
TEST(MeshPolygons, MayHaveCornersOnALine) {
  // The vertices 8 and 9 lie on edges of two faces each. Start each of these faces at each of its corners in turn.
  const std::vector<std::string> more = {"3 0 0", "3 5 0"};
  Words bottom = {"0", "2", "9", "3", "1", "8"}, front = {"0", "8", "1", "5", "4"}, back = {"2", "6", "7", "3", "9"};
  for (int start = 0; start < 6; ++start) {
    std::vector<std::string> faces = {"4 5 7 6", "0 4 6 2", "1 3 7 5"};
    for (Words* face : {&bottom, &front, &back}) {
      std::rotate(face->begin(), face->begin() + 1, face->end());
      faces.push_back(fmt::format("{}", fmt::join(*face, " ")));
    }
    for (const auto& [name, text] : boxes(faces, more)) {
      SCOPED_TRACE(name + " " + faces[3]);
      const MeshFile mesh(text, name, {});
      EXPECT_TRUE(mesh.is_closed());
      EXPECT_TRUE(mesh.warnings(name).empty());
      EXPECT_EQ(mesh.points().size(), 10u);
      EXPECT_NEAR(volume_of(mesh), 90.0, 1e-12);
    }
  }
  // The warning counts the polygons in which a corner is listed twice in succession, or again at the end.
  for (const std::string corners : {"0 2 2 3 1", "0 2 3 1 0"}) {
    std::vector<std::string> faces = kQuadrilaterals;
    faces[0] = corners;
    for (const auto& [name, text] : boxes(faces))
      EXPECT_EQ(warning_of(name, text).find(": polygons whose repeated corners were left out: 1, the first in l"), 0u)
          << warning_of(name, text);
  }
}

}  // namespace
}  // namespace hapbench::mesh_polygons_test
