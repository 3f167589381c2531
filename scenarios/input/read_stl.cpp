#include "scenarios/input/read_stl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// Sizes in a binary file [bytes]. kName: the name. kHeader: the name and the number of triangles. kTriangle: one
// triangle.
constexpr std::size_t kName = 80, kHeader = 84, kTriangle = 50;

/// Keywords of an STL file in text form.
constexpr std::array<std::string_view, 7> kKeywords = {"solid",   "facet",    "outer",   "vertex",
                                                       "endloop", "endfacet", "endsolid"};

/// Reads the keywords of a text one by one, in lower case. Line ends separate tokens as blanks do.
class StlKeywords {
 public:
  StlKeywords(std::string_view text, const fs::path& file) : lines_(LineReader(text), file) {}

  /// Advances to the next keyword. Ignores other tokens in its line: normals, colours and names. Notes text
  /// other than numbers after the coordinates of a vertex. Returns false at the end of the text.
  bool next() {
    const std::size_t last = word_;
    while (++word_ < lines_.words().size() && !is_next_keyword())
      if (keyword_ == "vertex" && word_ > last + 3 && !finite_number(lines_.words()[word_])) lines_.note_ignored(word_);
    if (word_ >= lines_.words().size()) {
      word_ = 0;
      if (!lines_.next()) return false;
      if (!is_keyword(lines_.words()[0])) {
        lines_.fail(
            fmt::format("got {}; allowed: solid, facet, outer loop, three times vertex, endloop, endfacet, endsolid",
                        quoted_token(lines_.words()[0])));
      }
    }
    keyword_ = lower_case(lines_.words()[word_]);
    return true;
  }
  const std::string& keyword() const { return keyword_; }
  /// Returns the three coordinates after "vertex".
  Vec3 position() const { return lines_.position(word_ + 1); }
  const MeshLines& lines() const { return lines_; }

 private:
  /// Returns true if the current token is a keyword. The name of a solid may contain keywords. It ends at the end of
  /// the line, or before "facet normal" if the whole file is one line.
  bool is_next_keyword() const {
    const Words& words = lines_.words();
    if (keyword_ != "solid" && keyword_ != "endsolid") return is_keyword(words[word_]);
    return word_ + 1 < words.size() && lower_case(words[word_]) == "facet" && lower_case(words[word_ + 1]) == "normal";
  }
  static bool is_keyword(std::string_view word) {
    // First reject tokens that do not begin with a letter, because most tokens are numbers.
    const bool has_letter = ('a' <= word[0] && word[0] <= 'z') || ('A' <= word[0] && word[0] <= 'Z');
    return has_letter && std::ranges::find(kKeywords, lower_case(word)) != kKeywords.end();
  }

  MeshLines lines_;
  std::size_t word_ = 0;  ///< index of the keyword in the line
  std::string keyword_;
};

/// Appends a vertex that belongs to the current triangle only. `line` is 0 in a binary file.
void add_corner(const Vec3& corner, std::size_t line, MeshFaces& faces) {
  faces.corners.push_back(static_cast<std::uint32_t>(faces.vertices.size()));
  faces.add_vertex(corner, line);
}

/// Reads the three vertices after "outer loop".
void read_loop(StlKeywords& keywords, MeshFaces& faces) {
  const std::size_t first_line = keywords.lines().line();
  for (int corner = 0; corner < 3; ++corner) {
    if (!keywords.next()) {
      keywords.lines().fail(
          fmt::format("the file is cut short: it ends within triangle {}; allowed: a complete file, up to "
                      "\"endsolid\"",
                      faces.ends.size()));
    }
    if (keywords.keyword() != "vertex") keywords.lines().fail("allowed after \"outer loop\": three vertices");
    add_corner(keywords.position(), keywords.lines().line(), faces);
  }
  faces.end_face(first_line);
}

MeshFaces read_stl_text(std::string_view text, const fs::path& file) {
  MeshFaces faces{.vertices = {}, .face_name = "triangle"};
  StlKeywords keywords(text, file);
  std::string last;
  while (keywords.next()) {
    const std::string& keyword = keywords.keyword();
    if (keyword == "vertex")
      keywords.lines().fail("got \"vertex\"; allowed: three times vertex after each \"outer loop\"");
    if (last == "facet" && keyword != "outer")
      keywords.lines().fail(fmt::format("got {} after \"facet\"; allowed: \"outer loop\" and three vertices", keyword));
    last = keyword;
    if (last == "outer") read_loop(keywords, faces);
  }
  if (last != "endsolid") {
    keywords.lines().fail(
        fmt::format("the file is cut short: it ends after {} triangles and \"{}\", without \"endsolid\"; "
                    "allowed: a complete file (if this file is complete, append \"endsolid\")",
                    faces.ends.size(), last));
  }
  keywords.lines().warn_of_ignored(faces.warnings);
  return faces;
}

MeshFaces read_stl_binary(ByteReader reader, std::size_t triangles, const fs::path& file) {
  MeshFaces faces{.vertices = {}, .face_name = "triangle"};
  for (std::size_t t = 0; t < triangles; ++t) {
    reader.skip(3 * sizeof(float));  // normal
    for (int k = 0; k < 3; ++k) {
      Vec3 corner;
      for (double& coordinate : corner) coordinate = reader.take<float>();
      if (!corner.allFinite()) fail_in_file(file, fmt::format("triangle {}: a vertex is not finite", t));
      add_corner(corner, 0, faces);
    }
    reader.skip(2);  // attributes
    faces.end_face(0);
  }
  if (const std::size_t left = reader.left(); left > 0) {
    const bool are_triangles = left % kTriangle == 0;
    faces.warnings.push_back(fmt::format(
        "bytes after the {} triangles that the header declares, which were ignored: {}{}", triangles, left,
        are_triangles ? fmt::format(", the size of {} more triangles; is the header wrong?", left / kTriangle) : ""));
  }
  return faces;
}

/// Returns true if the file begins as a text file does: its first token, without comments, is "solid", and its first
/// 1024 bytes have no zero byte. The header of a binary file may begin with "solid", too, but zero bytes follow it.
bool is_text(std::string_view text) {
  constexpr std::size_t kStart = 1024;
  const std::string_view start = text.substr(0, kStart);
  if (start.find('\0') != std::string_view::npos) return false;
  LineReader lines(start);
  while (const auto line = lines.next()) {
    const Words words = words_of(line->substr(0, line->find('#')));
    if (!words.empty()) return lower_case(words[0]) == "solid";
  }
  return false;
}

/// Throws InputError for a file that is neither a text nor a complete binary file. `triangles`: number of triangles
/// that a binary header declares. `complete`: number of triangles that the file contains.
[[noreturn]] void refuse(std::string_view text, std::size_t triangles, std::size_t complete, const fs::path& file) {
  constexpr const char* kAllowed = "; allowed: \"solid\" and text, or 84 bytes and 50 for each triangle";
  // If the first line is printable, the file is a text of another kind, such as a web page that a server sent instead
  // of the file. Quote this line, because the counts of triangles mean nothing in a text.
  constexpr std::size_t kShown = 40;
  const std::string_view first = LineReader(text).next().value_or("");
  const auto is_printable = [](unsigned char c) { return c >= 0x20 && c < 0x7f; };
  if (!first.empty() && std::ranges::all_of(first, is_printable) &&
      (first.size() < text.size() || text.size() >= kHeader))
    fail_in_line(
        file, 1,
        fmt::format("is not an STL file: it begins with {}{}", quoted_token(first.substr(0, kShown)), kAllowed));
  if (text.size() < kHeader) fail_in_file(file, fmt::format("is not an STL file, or cut short{}", kAllowed));
  fail_in_file(file, fmt::format("is not an STL file, or cut short: it holds {} of the {} triangles that its header "
                                 "declares{}",
                                 complete, triangles, kAllowed));
}

}  // namespace

MeshFaces read_stl(std::string_view text, const fs::path& file) {
  // Read the number of triangles as if the file was binary.
  ByteReader reader(text, std::endian::little);
  std::size_t triangles = 0, complete = 0;
  if (text.size() >= kHeader) {
    reader.skip(kName);
    triangles = reader.take<std::uint32_t>();
    complete = reader.left() / kTriangle;
  }
  // A file with exactly the declared size is binary, even if its header begins like a text.
  const bool is_exact = text.size() == kHeader + kTriangle * triangles;
  if (is_text(text) && !is_exact) return read_stl_text(text, file);
  if (text.size() < kHeader || complete < triangles) refuse(text, triangles, complete, file);
  if (triangles == 0 && reader.left() > 0)
    fail_in_file(file, fmt::format("its header declares 0 triangles, and {} bytes follow; allowed: the number of "
                                   "triangles in the bytes 80 to 83",
                                   reader.left()));
  return read_stl_binary(reader, triangles, file);
}

}  // namespace hapbench
