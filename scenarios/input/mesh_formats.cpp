#include "scenarios/input/mesh_formats.hpp"

#include <fmt/format.h>

#include <charconv>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

// ---- OBJ

/// Index of the vertex that a corner of a face names. "7/1/3" is the seventh vertex of the file, which may come later;
/// "-1" is the last of the `vertices` read so far.
std::uint32_t vertex_of(std::string_view word, std::size_t vertices, const MeshLines& lines) {
  const std::string_view number = word.substr(0, word.find('/'));
  int index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  const bool parsed = error == std::errc() && end == number.data() + number.size();
  const auto count = static_cast<std::int64_t>(vertices);
  if (!parsed || index == 0 || index < -count) {
    lines.fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one",
                           quoted_word(word)));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

// ---- OFF

/// Reads what follows the header's keyword. Normals, colours and texture coordinates come after the position or the
/// corners and are ignored.
TriangleSoup read_off_text(MeshLines& lines) {
  // The counts may stand in the line of the header.
  const std::size_t counts = lines.words().size() > 1 ? 1 : 0;
  if (counts == 0 && !lines.next()) lines.fail("the file ends before its counts of vertices, faces and edges");
  const std::size_t vertices = lines.count(counts, "vertices"), faces = lines.count(counts + 1, "faces");
  TriangleSoup soup;
  for (std::size_t i = 0; i < vertices; ++i) {
    if (!lines.next())
      lines.fail(fmt::format("the file ends before its {} vertices; allowed: a complete file", vertices));
    soup.vertices.push_back(lines.position(0));
  }
  for (std::size_t i = 0; i < faces; ++i) {
    if (!lines.next()) lines.fail(fmt::format("the file ends before its {} faces; allowed: a complete file", faces));
    lines.add_face(i, 0, soup);
  }
  return soup;
}

// ---- STL

constexpr std::size_t kName = 80, kHeader = 84, kTriangle = 50;  // bytes of a binary file

void add_triangle(const std::array<Vec3, 3>& corners, TriangleSoup& soup) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), corners.begin(), corners.end());
  soup.triangles.push_back({first, first + 1, first + 2});
}

TriangleSoup read_stl_text(std::string_view text, const std::filesystem::path& file) {
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
                      quoted_word(lines.words()[0])));
    }
  }
  return soup;
}

TriangleSoup read_stl_binary(ByteReader reader, std::size_t triangles, const std::filesystem::path& file) {
  TriangleSoup soup;
  for (std::size_t t = 0; t < triangles; ++t) {
    reader.skip(3 * sizeof(float));  // the normal
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

void add_polygon(std::span<const std::uint32_t> corners, TriangleSoup& soup) {
  for (std::size_t i = 2; i < corners.size(); ++i) soup.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file) {
  TriangleSoup soup;
  std::vector<std::uint32_t> corners;
  MeshLines lines{LineReader(text), file};
  while (lines.next()) {
    const Words& words = lines.words();
    if (words[0] == "v") {
      soup.vertices.push_back(lines.position(1));
    } else if (words[0] == "f") {
      if (words.size() < 4)
        lines.fail(fmt::format("got a face with {} corners; allowed: at least 3", words.size() - 1));
      corners.clear();
      for (std::size_t i = 1; i < words.size(); ++i)
        corners.push_back(vertex_of(words[i], soup.vertices.size(), lines));
      add_polygon(corners, soup);
    }
  }
  return soup;
}

TriangleSoup read_off(std::string_view text, const std::filesystem::path& file) {
  MeshLines lines{LineReader(text), file};
  constexpr std::array<std::string_view, 8> kKinds = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                      "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (!lines.next() || std::find(kKinds.begin(), kKinds.end(), lines.words()[0]) == kKinds.end())
    lines.fail("is not an OFF file; allowed: \"OFF\" in the first line, perhaps with ST, C or N before it");
  const Words& header = lines.words();
  if (header.size() > 1 && header[1] == "BINARY")
    lines.fail("is a binary OFF file; allowed: a text, or binary PLY or STL");
  return read_off_text(lines);
}

TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file) {
  const std::string first_word = lower_case(text.substr(0, text.find_first_of(" \t\r\n")));
  ByteReader reader(text, std::endian::little);
  std::size_t triangles = 0;
  bool complete = text.size() >= kHeader;
  if (complete) {
    reader.skip(kName);
    triangles = reader.take<std::uint32_t>();
    complete = reader.left() / kTriangle >= triangles;
  }
  // Binary files may begin with "solid" too, but not fill their header with text.
  const bool exact = complete && text.size() == kHeader + kTriangle * triangles;
  const bool is_text = text.substr(0, kHeader).find('\0') == std::string_view::npos;
  if (first_word == "solid" && is_text && !exact) return read_stl_text(text, file);
  if (!complete)
    fail_in_file(file,
                 "is no STL file, or cut short; allowed: \"solid\" and text, or 84 bytes and 50 for each triangle");
  return read_stl_binary(reader, triangles, file);
}

}  // namespace hapbench
