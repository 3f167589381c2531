#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_formats.hpp"
#include "scenarios/input/mesh_lines.hpp"

namespace hapbench {
namespace {

/// After the header's own word. Normals, colours and texture coordinates stand behind the position or the corners.
TriangleSoup read_text(MeshLines& lines) {
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

/// Counts, vertices and faces behind the line "OFF BINARY".
TriangleSoup read_binary(std::string_view bytes, const std::filesystem::path& file) {
  ByteReader reader(bytes, std::endian::little);
  const auto need = [&](std::size_t numbers, const char* what) {
    if (reader.left() / 4 < numbers)
      fail_in_file(file, fmt::format("ends before its {}; allowed: a complete, little endian file", what));
  };
  need(3, "faces");
  const auto vertices = reader.take<std::uint32_t>(), faces = reader.take<std::uint32_t>();
  reader.skip(4);  // the count of edges
  need(3 * std::size_t{vertices}, "faces");
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const auto x = reader.take<float>(), y = reader.take<float>(), z = reader.take<float>();
    soup.vertices.push_back(Vec3(x, y, z));
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < faces; ++i) {
    need(1, "faces");
    const auto count = reader.take<std::uint32_t>();
    if (count < 3) fail_in_file(file, fmt::format("face {}: got {} corners; allowed: at least 3", i, count));
    need(count, i + 1 == faces ? "last face" : "faces");
    corners.clear();
    for (std::uint32_t k = 0; k < count; ++k) corners.push_back(reader.take<std::uint32_t>());
    add_polygon(corners, soup);
  }
  return soup;
}

}  // namespace

TriangleSoup read_off(std::string_view text, const std::filesystem::path& file) {
  MeshLines lines{LineReader(text), file};
  constexpr std::array<std::string_view, 8> kKinds = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                      "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (!lines.next() || std::find(kKinds.begin(), kKinds.end(), lines.words()[0]) == kKinds.end())
    lines.fail("is not an OFF file; allowed: \"OFF\" in the first line, perhaps with ST, C or N before it");
  const Words& header = lines.words();
  if (header.size() == 1 || header[1] != "BINARY") return read_text(lines);
  if (header[0] != "OFF") lines.fail("allowed for a binary file: no normals, colours or texture coordinates");
  return read_binary(lines.rest(), file);
}

}  // namespace hapbench
