#include "scenarios/input/read_obj.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Statements that are ignored without a warning. Some describe no surface, such as names, materials and normals. The
/// others are parts of free-form shapes; the warning about kOtherShapes covers them.
constexpr std::array<std::string_view, 31> kWithoutShape = {
    "vt",   "vn",     "g",        "o",        "s",    "mg",         "mtllib",    "usemtl", "usemap", "maplib", "bevel",
    "lod",  "trace",  "c_interp", "d_interp", "end",  "shadow_obj", "trace_obj", "ctech",  "stech",  "vp",     "deg",
    "parm", "cstype", "bmat",     "step",     "trim", "hole",       "scrv",      "sp",     "con"};
/// Statements with shapes other than polygons, and statements that include another file.
constexpr std::array<std::string_view, 12> kOtherShapes = {"p",   "l",   "curv", "curv2", "surf", "bzp",
                                                           "bsp", "cdc", "cdp",  "res",   "call", "csh"};

/// Counts statements that are ignored, to report each kind once.
class IgnoredStatements {
 public:
  void add(std::string_view keyword, std::size_t line) {
    if (std::ranges::find(kWithoutShape, keyword) != kWithoutShape.end()) return;
    if (kinds_.size() >= kMaxKinds && !kinds_.contains(keyword)) return;
    Lines& lines = kinds_.try_emplace(keyword, Lines{line, 0}).first->second;
    ++lines.count;
  }
  void report(std::vector<std::string>& warnings) const {
    for (const auto& [keyword, lines] : kinds_) {
      warnings.push_back(fmt::format("{} {}, which were ignored: {}, the first is line {}",
                                     is_other_shape(keyword) ? "statements other than polygons," : "unknown statements",
                                     quoted_token(keyword), lines.count, lines.first));
    }
  }
  /// Throws InputError at the first unknown statement; does nothing if all statements are known. Called if the file has
  /// no faces, because such a file may have another format than OBJ.
  void refuse_first_unknown(const fs::path& file) const {
    const auto* first = static_cast<const std::pair<const std::string_view, Lines>*>(nullptr);
    for (const auto& kind : kinds_)
      if (!is_other_shape(kind.first) && (first == nullptr || kind.second.first < first->second.first)) first = &kind;
    if (first == nullptr) return;
    fail_in_line(file, first->second.first,
                 fmt::format("got {}, and the file has no faces; allowed: statements of OBJ, such as \"v 0 0 0\" and "
                             "\"f 1 2 3\"",
                             quoted_token(first->first)));
  }

 private:
  static bool is_other_shape(std::string_view keyword) {
    return std::ranges::find(kOtherShapes, keyword) != kOtherShapes.end();
  }

  static constexpr std::size_t kMaxKinds = 5;
  struct Lines {
    std::size_t first, count;
  };
  std::map<std::string_view, Lines> kinds_;
};

/// Returns the vertex index, from 0, of a face's corner. The token "7/1/3" means the file's 7th vertex. The token
/// "-1" means the last of the `vertices` vertices that were read so far.
std::uint32_t vertex_of(std::string_view word, std::size_t vertices, const MeshLines& lines) {
  const auto index = parse_number<int>(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  if (!index || *index == 0 || *index < -count) {
    lines.fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one",
                           quoted_token(word)));
  }
  return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
}

/// Reads a face. Throws InputError if the end of the file cuts off the last corner, as in "f 1/1 2/2 3/".
void read_face(const MeshLines& lines, MeshFaces& faces) {
  const Words& words = lines.words();
  if (words.size() < 4) lines.fail(fmt::format("got a face with {} corners; allowed: at least 3", words.size() - 1));
  for (std::size_t k = 1; k < words.size(); ++k)
    faces.corners.push_back(vertex_of(words[k], faces.vertices.size(), lines));
  const auto slashes = [](std::string_view word) { return std::ranges::count(word, '/') + word.ends_with('/'); };
  if (lines.may_be_cut() && slashes(words.back()) != slashes(words[1]))
    lines.fail(fmt::format("got {}; allowed: a corner such as {}", quoted_token(words.back()), quoted_token(words[1])));
  faces.end_face(lines.line());
}

/// Notes a vertex with other text than numbers, or with more numbers than a position, a weight and a colour have.
void note_other_text(MeshLines& lines) {
  constexpr std::size_t kMostWords = 8;  // "v", position, weight, colour
  for (std::size_t k = 4; k < lines.words().size(); ++k)
    if (k >= kMostWords || !finite_number(lines.words()[k])) lines.note_ignored(k);
}

}  // namespace

MeshFaces read_obj(std::string_view text, const fs::path& file) {
  MeshFaces faces{.vertices = {}, .first_vertex = 1};
  MeshLines lines{LineReader(text), file, Continuation::backslash};
  IgnoredStatements ignored;
  std::size_t weighted = 0;  // line of the first vertex with a weight
  while (lines.next()) {
    const Words& words = lines.words();
    if (words[0] == "v") {
      faces.add_vertex(lines.position(1), lines.line());
      note_other_text(lines);
      if (words.size() == 5 && weighted == 0 && finite_number(words[4]).value_or(1.0) != 1.0) weighted = lines.line();
    } else if (words[0] == "f" || words[0] == "fo") {
      read_face(lines, faces);
      faces.unfinished_line = lines.may_be_cut() ? lines.line() : 0;
    } else {
      // The backslash at the end of a folder name, such as "mtllib C:\\models\\", joins the next line to this line.
      if (lines.joined_token() == "v" || lines.joined_token() == "f") {
        lines.fail(
            fmt::format("got {} with a backslash at its end, which joins the next line, {}, to it; allowed: a name "
                        "without a backslash at its end",
                        quoted_token(words[0]), quoted_token(lines.joined_token())));
      }
      ignored.add(words[0], lines.line());
    }
  }
  if (faces.ends.empty()) ignored.refuse_first_unknown(file);
  ignored.report(faces.warnings);
  lines.warn_of_ignored(faces.warnings);
  if (weighted > 0)
    faces.warnings.push_back(fmt::format("weights of vertices, which were ignored: the first in line {}", weighted));
  return faces;
}

}  // namespace hapbench
