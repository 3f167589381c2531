#include "scenarios/input/read_off.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Keywords of the text formats of OFF. The letters before "OFF" name the data of a vertex besides its position.
constexpr std::array<std::string_view, 8> kKinds = {"STCNOFF", "STCOFF", "STNOFF", "STOFF",
                                                    "CNOFF",   "COFF",   "NOFF",   "OFF"};

/// Returns the keyword at the start of the first token, in capitals; empty if the token has no keyword. The count of
/// vertices may follow without a blank, as in "OFF8 6 12".
std::string_view keyword_of(std::string_view word) {
  const auto is_start = [word](std::string_view kind) {
    return lower_case(word.substr(0, kind.size())) == lower_case(kind) &&
           (word.size() == kind.size() || whole_number(word.substr(kind.size())));
  };
  const auto* found = std::ranges::find_if(kKinds, is_start);
  return found == kKinds.end() ? "" : *found;
}

/// Returns true for the keyword of a file whose vertices have four coordinates (4OFF) or any number of coordinates
/// (nOFF). The small letter distinguishes "nOFF" from "NOFF", which has vertices with normals.
bool has_other_dimension(std::string_view word) {
  const std::size_t at = word.find("OFF");
  return at != std::string_view::npos && word.substr(0, at).find_first_of("4n") != std::string_view::npos &&
         word.substr(0, at).find_first_not_of("STCN4n") == std::string_view::npos;
}

/// Numbers of vertices and faces that the header declares.
struct Counts {
  std::size_t vertices, faces;
  bool has_edges;  ///< false: the number of edges may follow in a separate line
};

/// Reads the counts, which follow the keyword in the same line or in the next lines. `length`: number of letters of the
/// keyword; 0 if the file has no keyword.
Counts read_counts(std::size_t length, MeshLines& lines) {
  std::size_t word = length > 0 ? 1 : 0;  // index of the next token in the line
  const auto next_count = [&](const char* what) {
    while (word >= lines.words().size()) {
      if (!lines.next())
        lines.fail("the file ends before its counts of vertices, faces and edges; allowed: a complete file");
      word = 0;
    }
    return lines.count(word++, what);
  };
  const std::string_view first = lines.words()[0];
  const bool is_glued = length > 0 && first.size() > length;
  const std::size_t vertices = is_glued ? whole_number(first.substr(length)).value() : next_count("vertices");
  const std::size_t faces = next_count("faces");
  const std::size_t left = lines.words().size() - word;
  if (left > 3)
    lines.fail(
        fmt::format("got {} values after the counts of vertices and faces; allowed: the number of edges, and then "
                    "each vertex and each face in a line of its own",
                    left));
  return {vertices, faces, left > 0};
}

/// Reads the vertices. Ignores numbers after the position of a vertex, such as normals or colours, and warns about
/// other text in the line. Returns the largest number of tokens in the line of a vertex.
std::size_t read_vertices(const Counts& counts, MeshLines& lines, MeshFaces& faces) {
  std::size_t tokens = 3;
  for (std::size_t i = 0; i < counts.vertices; ++i) {
    const bool has_line = lines.next();
    const bool is_edges = has_line && i == 0 && !counts.has_edges && lines.words().size() == 1 &&
                          whole_number(lines.words()[0]).has_value();
    if (!has_line || (is_edges && !lines.next())) lines.fail_at_end(i, counts.vertices, "vertices");
    faces.add_vertex(lines.position(0), lines.line());
    tokens = std::max(tokens, lines.words().size());
    for (std::size_t k = 3; k < lines.words().size(); ++k)
      if (!finite_number(lines.words()[k])) lines.note_ignored(k);
  }
  lines.warn_of_ignored(faces.warnings);
  return tokens;
}

/// Parses the part of the file after the header. Ignores tokens after the corners of a face. `has_more`: true if the
/// header announces further values in the line of a vertex, such as a normal.
MeshFaces read_entries(const Counts& counts, bool has_more, MeshLines& lines) {
  MeshFaces faces;
  const std::size_t tokens = read_vertices(counts, lines, faces);
  for (std::size_t i = 0; i < counts.faces; ++i) {
    const bool has_line = lines.next();
    if (!has_line) {
      const bool has_several = !has_more && tokens >= 6 && tokens % 3 == 0;
      lines.fail_at_end(i, counts.faces,
                        has_several ? fmt::format("faces (a line with a vertex has {} values: if these are several "
                                                  "vertices, write each in a line of its own)",
                                                  tokens)
                                    : "faces");
    }
    const std::size_t count = lines.count(0, "corners");
    if (count < 3 || lines.words().size() <= count)
      lines.fail(fmt::format("face {}: got {} corners and {} vertices; allowed: at least 3, and as many vertices", i,
                             count, lines.words().size() - 1));
    for (std::size_t k = 1; k <= count; ++k)
      faces.corners.push_back(static_cast<std::uint32_t>(lines.count(k, "as a vertex")));
    faces.end_face(lines.line());
  }
  if (lines.may_be_cut()) faces.unfinished_line = lines.line();
  lines.warn_of_rest(faces.warnings);
  return faces;
}

}  // namespace

MeshFaces read_off(std::string_view text, const fs::path& file) {
  MeshLines lines{LineReader(text), file};
  const auto refuse = [&lines] {
    lines.fail("is not an OFF file; allowed: \"OFF\" in the first line, perhaps with ST, C or N before it");
  };
  if (!lines.next()) refuse();
  const Words& header = lines.words();
  const std::string_view keyword = keyword_of(header[0]);
  // The format allows a file without a keyword. Such a file begins with its counts.
  const bool has_counts = header.size() == 3 && std::ranges::all_of(header, [](std::string_view word) {
                            return whole_number(word).has_value();
                          });
  if (has_other_dimension(header[0]))
    lines.fail(
        fmt::format("got {}, whose vertices do not have three coordinates; allowed: OFF, perhaps with ST, C or N "
                    "before it",
                    quoted_token(header[0])));
  if (keyword.empty() && !has_counts) refuse();
  if (header.size() > 1 && lower_case(header[1]) == "binary")
    lines.fail("is a binary OFF file; allowed: a text, or binary PLY or STL");
  return read_entries(read_counts(keyword.size(), lines), keyword.size() > 3, lines);
}

}  // namespace hapbench
