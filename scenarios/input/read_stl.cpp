#include "scenarios/input/read_stl.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// Sizes in a binary file [bytes]: the name, the name with the number of triangles, and one triangle.
constexpr std::size_t kName = 80, kHeader = 84, kTriangle = 50;

void add_triangle(const std::array<Vec3, 3>& corners, TriangleSoup& soup) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), corners.begin(), corners.end());
  soup.triangles.push_back({first, first + 1, first + 2});
}

TriangleSoup read_stl_text(std::string_view text, const fs::path& file) {
  TriangleSoup soup;
  MeshLines lines{LineReader(text), file};
  while (lines.next()) {
    const std::string first = lower_case(lines.words()[0]);
    if (first == "outer") {
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        if (!lines.next() || lower_case(lines.words()[0]) != "vertex")
          lines.fail("allowed after \"outer loop\": three vertices");
        corner = lines.position(1);
      }
      add_triangle(corners, soup);
    } else if (first != "solid" && first != "facet" && first != "endloop" && first != "endfacet" &&
               first != "endsolid") {
      lines.fail(
          fmt::format("got {}; allowed: solid, facet, outer loop, three times vertex, endloop, endfacet, endsolid",
                      quoted_token(lines.words()[0])));
    }
  }
  return soup;
}

TriangleSoup read_stl_binary(ByteReader reader, std::size_t triangles, const fs::path& file) {
  TriangleSoup soup;
  for (std::size_t t = 0; t < triangles; ++t) {
    reader.skip(3 * sizeof(float));  // normal
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) {
      for (double& coordinate : corner) coordinate = reader.take<float>();
      if (!corner.allFinite()) fail_in_file(file, fmt::format("triangle {}: a vertex is not finite", t));
    }
    reader.skip(2);  // attributes
    add_triangle(corners, soup);
  }
  return soup;
}

}  // namespace

TriangleSoup read_stl(std::string_view text, const fs::path& file) {
  // Read the number of triangles as if the file were binary.
  const std::string first_word = lower_case(text.substr(0, text.find_first_of(" \t\r\n")));
  ByteReader reader(text, std::endian::little);
  std::size_t triangles = 0;
  bool complete = text.size() >= kHeader;
  if (complete) {
    reader.skip(kName);
    triangles = reader.take<std::uint32_t>();
    complete = reader.left() / kTriangle >= triangles;
  }
  // Decide whether the file is a text. Binary files may also begin with "solid", but then their size is exact or
  // their header contains zero bytes.
  const bool exact = complete && text.size() == kHeader + kTriangle * triangles;
  const bool is_text = text.substr(0, kHeader).find('\0') == std::string_view::npos;
  if (first_word == "solid" && is_text && !exact) return read_stl_text(text, file);
  if (!complete)
    fail_in_file(file,
                 "is not an STL file, or cut short; allowed: \"solid\" and text, or 84 bytes and 50 for each triangle");
  return read_stl_binary(reader, triangles, file);
}

}  // namespace hapbench
