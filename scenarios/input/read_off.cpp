#include "scenarios/input/read_off.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Parses the part of the file after the keyword "OFF". Ignores tokens after the position of a vertex or the
/// corners of a face, such as normals or colours.
TriangleSoup read_off_text(MeshLines& lines) {
  // Read the counts, which may be in the line of the keyword.
  const std::size_t counts = lines.words().size() > 1 ? 1 : 0;
  if (counts == 0 && !lines.next()) lines.fail("the file ends before its counts of vertices, faces and edges");
  const std::size_t vertices = lines.count(counts, "vertices"), faces = lines.count(counts + 1, "faces");
  const auto next = [&lines](std::size_t count, const char* what) {
    if (!lines.next()) lines.fail(fmt::format("the file ends before its {} {}; allowed: a complete file", count, what));
  };
  // Read the vertices.
  TriangleSoup soup;
  for (std::size_t i = 0; i < vertices; ++i) {
    next(vertices, "vertices");
    soup.vertices.push_back(lines.position(0));
  }
  // Read the faces.
  for (std::size_t i = 0; i < faces; ++i) {
    next(faces, "faces");
    const std::size_t count = lines.count(0, "corners");
    if (count < 3 || lines.words().size() <= count)
      lines.fail(fmt::format("face {}: got {} corners; allowed: at least 3, and as many vertices", i, count));
    add_polygon(count, soup,
                [&](std::size_t k) { return static_cast<std::uint32_t>(lines.count(k + 1, "as a vertex")); });
  }
  return soup;
}

}  // namespace

TriangleSoup read_off(std::string_view text, const fs::path& file) {
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

}  // namespace hapbench
