#include "scenarios/input/mesh_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/ply_header.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string quoted(std::string_view word) {
  return shown(Json(word.substr(0, 60)));
}

/// Checks and reduces a text file, line by line. Comments and blank lines are passed over.
class Reducer {
 public:
  Reducer(const fs::path& file, LineReader lines) : file_(file), lines_(lines) {}

  std::string obj() {
    int vertices = 0;
    while (next_words()) {
      if (words_[0] == "v") {
        add("v", position(1));
        ++vertices;
      } else if (words_[0] == "f") {
        if (words_.size() < 4) fail(fmt::format("got a face with {} corners; allowed: at least 3", words_.size() - 1));
        for (std::size_t i = 1; i < words_.size(); ++i) words_[i] = obj_vertex(words_[i], vertices);
        add("f", {words_.begin() + 1, words_.end()});
      }
    }
    return std::move(reduced_);
  }

  std::string stl() {
    while (next_words()) {
      const std::string first = lower_case(words_[0]);
      if (first == "outer") {
        add("outer", {});
        for (int i = 0; i < 3; ++i) {
          if (!next_words() || lower_case(words_[0]) != "vertex") fail("allowed after \"outer loop\": three vertices");
          add("vertex", position(1));
        }
      } else if (first != "solid" && first != "facet" && first != "endloop" && first != "endfacet" &&
                 first != "endsolid") {
        fail(fmt::format("got {}; allowed: solid, facet, outer loop, three times vertex, endloop, endfacet, endsolid",
                         quoted(words_[0])));
      }
    }
    return std::move(reduced_);
  }

  /// After the header line. Normals, colours and texture coordinates stand behind the position, or the face.
  std::string off() {
    next_words();
    // The counts may stand in the line of the header.
    if (words_.size() > 1) {
      words_.erase(words_.begin());
    } else if (!next_words()) {
      fail("the file ends before its counts of vertices, faces and edges");
    }
    const auto vertices = count(0, "vertices"), faces = count(1, "faces");
    reduced_ = fmt::format("OFF\n{} {} 0\n", vertices, faces);
    for (std::size_t i = 0; i < vertices; ++i) {
      if (!next_words()) fail(fmt::format("the file ends before its {} vertices; allowed: a complete file", vertices));
      add("", position(0));
    }
    for (std::size_t i = 0; i < faces; ++i) {
      if (!next_words()) fail(fmt::format("the file ends before its {} faces; allowed: a complete file", faces));
      add_corners(i);
    }
    return std::move(reduced_);
  }

  /// After the header. Each vertex and each face has a line; what stands behind the position or the corners is left
  /// out.
  std::string ply(const PlyHeader& header) {
    for (const PlyHeader::Element& element : header.elements) {
      const std::size_t entries = *whole_number(element.words[2]);
      const bool vertex = element.words[1] == "vertex", face = element.words[1] == "face";
      reduced_ += vertex ? fmt::format(
                               "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                               "property float z\nelement face {}\nproperty list int int vertex_indices\nend_header\n",
                               entries, face_count(header))
                         : "";
      const auto coordinates = vertex ? coordinate_words(element) : std::array<std::size_t, 3>{};
      for (std::size_t i = 0; i < entries; ++i) {
        if (!next_words())
          fail(fmt::format("the file ends before its {} {}; allowed: a complete file", entries,
                           quoted(element.words[1])));
        if (vertex) add_ply_vertex(coordinates, element.properties.size());
        if (face) add_corners(i);
      }
      if (face) break;  // the library reads no further either
    }
    return std::move(reduced_);
  }

 private:
  static std::size_t face_count(const PlyHeader& header) {
    for (const PlyHeader::Element& element : header.elements) {
      if (element.words[1] == "face") return *whole_number(element.words[2]);
    }
    return 0;
  }

  /// Which words of a vertex's line are x, y and z.
  static std::array<std::size_t, 3> coordinate_words(const PlyHeader::Element& vertex) {
    std::array<std::size_t, 3> words{};
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
      const std::string_view name = vertex.properties[i].words[2];
      if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') words[static_cast<std::size_t>(name[0] - 'x')] = i;
    }
    return words;
  }

  void add_ply_vertex(const std::array<std::size_t, 3>& coordinates, std::size_t properties) {
    if (words_.size() < properties)
      fail(fmt::format("got {} values; allowed: the {} of a vertex", words_.size(), properties));
    words_ = {words_[coordinates[0]], words_[coordinates[1]], words_[coordinates[2]]};
    add("", position(0));
  }

  /// The line of face i: how many corners, then as many vertices.
  void add_corners(std::size_t i) {
    const std::size_t corners = count(0, "corners");
    if (corners < 3 || words_.size() <= corners)
      fail(fmt::format("face {}: got {} corners; allowed: at least 3, and as many vertices", i, corners));
    for (std::size_t k = 1; k <= corners; ++k) count(k, "as a vertex");
    add("", {words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(corners) + 1});
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(file_, lines_.line(), problem); }

  /// Goes to the next line that has words, without its comment.
  bool next_words() {
    while (const auto line = lines_.next()) {
      words_ = words_of(line->substr(0, line->find('#')));
      if (!words_.empty()) return true;
    }
    return false;
  }

  /// The three coordinates from word `first` on, in single precision, as the library keeps them.
  Words position(std::size_t first) {
    if (words_.size() < first + 3) fail(fmt::format("got {} coordinates; allowed: 3", words_.size() - first));
    for (std::size_t i = first; i < first + 3; ++i) {
      std::string_view& word = words_[i];
      if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
      const auto value = finite_number(word);
      if (!value || std::abs(*value) > std::numeric_limits<float>::max())
        fail(fmt::format("got {}; allowed: a finite number", quoted(word)));
    }
    const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, begin + 3};
  }

  /// "7/1/3" names the vertex 7, which may come later; "-1" the last one of those so far.
  std::string_view obj_vertex(std::string_view word, int vertices) const {
    const std::string_view vertex = word.substr(0, word.find('/'));
    int index = 0;
    const auto [end, error] = std::from_chars(vertex.data(), vertex.data() + vertex.size(), index);
    if (error != std::errc() || end != vertex.data() + vertex.size() || index == 0 || index < -vertices)
      fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one", quoted(word)));
    return vertex;
  }

  /// A count or index, within what the library keeps.
  std::size_t count(std::size_t word, const char* what) const {
    const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
    const std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (!number || *number > most) {
      fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted(words_[word]) : "no",
                       what));
    }
    return *number;
  }

  void add(std::string_view first, const Words& rest) {
    reduced_ += first;
    for (const std::string_view word : rest) (reduced_ += ' ') += word;
    reduced_ += '\n';
  }

  const fs::path& file_;
  LineReader lines_;
  Words words_;          ///< of the line at hand
  std::string reduced_;  ///< what the library gets
};

[[noreturn]] void fail(const fs::path& file, const std::string& problem) {
  throw InputError(InputError::Kind::relation, file.string(), problem);
}

/// Four bytes from `start` on, the lowest first; none beyond the end.
std::optional<std::size_t> binary_count(std::string_view text, std::size_t start) {
  if (text.size() < 4 || start > text.size() - 4) return std::nullopt;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    count |= static_cast<std::size_t>(static_cast<unsigned char>(text[start + i])) << (8 * i);
  return count;
}

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

/// Size of a binary STL file with as many triangles as this one declares.
std::size_t stl_size(std::string_view text) {
  const auto triangles = binary_count(text, kStlHeader - 4);
  return triangles ? kStlHeader + kStlTriangle * *triangles : std::numeric_limits<std::size_t>::max();
}

MeshText stl_text(const fs::path& file, std::string text) {
  // Binary files may begin with "solid" too; their size tells.
  const std::size_t size = stl_size(text);
  const bool solid = lower_case(text.substr(0, text.find_first_of(" \t\r\n"))) == "solid";
  if (text.size() != size && solid) return {MeshFormat::stl, Reducer(file, LineReader(text)).stl()};
  if (text.size() < size)
    fail(file, "is no STL file, or cut short; allowed: \"solid\" and text, or 84 bytes and 50 for each triangle");
  for (std::size_t start = kStlHeader; start < size; start += kStlTriangle) {
    std::array<float, 12> values;  // normal and three vertices
    std::memcpy(values.data(), text.data() + start, sizeof values);
    // The library takes a vertex that is no number for one it has seen.
    if (std::any_of(values.begin() + 3, values.end(), [](float v) { return !std::isfinite(v); }))
      fail(file, fmt::format("triangle {}: a vertex is not finite", (start - kStlHeader) / kStlTriangle));
  }
  return {MeshFormat::binary_stl, std::move(text)};
}

/// The library goes on at the end of the file, with old values, for as many faces and corners as are declared.
void check_binary_off(std::string_view text, const fs::path& file) {
  const std::size_t counts = text.find('\n') + 1;
  const auto vertices = binary_count(text, counts), faces = binary_count(text, counts + 4);
  std::size_t start = counts + 12 + 12 * vertices.value_or(0);
  for (std::size_t i = 0; i < faces.value_or(1); ++i) {
    const auto corners = binary_count(text, start);
    if (!corners || *corners > text.size())
      fail(file, "ends before its faces; allowed: a complete, little endian file");
    start += 4 * (1 + *corners);
  }
  if (start > text.size()) fail(file, "ends before its last face; allowed: a complete, little endian file");
}

MeshText off_text(const fs::path& file, std::string text) {
  const std::string_view first_line = std::string_view(text).substr(0, text.find('\n'));
  const Words header = words_of(first_line.substr(0, first_line.find('#')));
  constexpr std::array<std::string_view, 8> kKinds = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                      "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (header.empty() || std::find(kKinds.begin(), kKinds.end(), header[0]) == kKinds.end())
    fail_in_line(file, 1, "is not an OFF file; allowed: \"OFF\" in the first line, perhaps with ST, C or N before it");
  if (header.size() == 1 || header[1] != "BINARY") return {MeshFormat::off, Reducer(file, LineReader(text)).off()};
  if (header[0] != "OFF")
    fail_in_line(file, 1, "allowed for a binary file: no normals, colours or texture coordinates");
  check_binary_off(text, file);
  return {MeshFormat::binary_off, std::move(text)};
}

/// The list of a face's vertices, as far as the library reads it.
void check_ply_face(const PlyHeader::Declaration& property, const fs::path& file) {
  const Words& words = property.words;
  constexpr std::array<std::string_view, 4> kCountTypes = {"uchar", "uint8", "uint16", "int"};
  if (words.size() == 5 && words[1] == "list" && (words[4] == "vertex_indices" || words[4] == "vertex_index")) {
    const auto index = ply_type(words[3]);
    const bool counted = std::find(kCountTypes.begin(), kCountTypes.end(), words[2]) != kCountTypes.end();
    if (counted && index && index->kind != PlyType::Kind::real) return;
  }
  fail_in_line(
      file, property.line,
      "allowed as the first property of a face: \"property list COUNT INDEX vertex_indices\" with COUNT uchar, "
      "uint8, uint16 or int and an integer type as INDEX");
}

/// Returns the coordinate a scalar property is, or nothing.
std::string check_ply_scalar(const PlyHeader::Declaration& property, bool of_vertex, const fs::path& file) {
  const Words& words = property.words;
  const auto type = words.size() == 3 ? ply_type(words[1]) : std::nullopt;
  if (!type) fail_in_line(file, property.line, "allowed: \"property TYPE NAME\"; no lists but the vertices of a face");
  if (!of_vertex || (words[2] != "x" && words[2] != "y" && words[2] != "z")) return "";
  if (type->kind != PlyType::Kind::real) fail_in_line(file, property.line, "allowed for a coordinate: float or double");
  return std::string(words[2]);
}

/// Refuses what the library would read wrongly. It reads no further than the faces.
void check_ply_header(const PlyHeader& header, const fs::path& file) {
  std::string coordinates;
  for (const PlyHeader::Element& element : header.elements) {
    if (element.words.size() != 3 || !whole_number(element.words[2]))
      fail_in_line(file, element.line, "allowed: \"element NAME COUNT\"");
    const bool vertex = element.words[1] == "vertex", face = element.words[1] == "face";
    if (face && element.properties.empty()) fail_in_line(file, element.line, "the faces have no list of vertices");
    for (const PlyHeader::Declaration& property : element.properties) {
      if (face && &property == &element.properties.front()) {
        check_ply_face(property, file);
      } else {
        coordinates += check_ply_scalar(property, vertex, file);
      }
    }
    std::sort(coordinates.begin(), coordinates.end());
    if (face && coordinates == "xyz") return;
    if (face) fail_in_line(file, element.line, "allowed before the faces: vertices with one each of x, y and z");
  }
  fail_in_line(file, header.last_line, "has no faces; allowed: \"element face COUNT\"");
}

MeshText ply_text(const fs::path& file, std::string text) {
  LineReader lines(text);
  const PlyHeader header = read_ply_header(lines, file);
  check_ply_header(header, file);
  if (header.format == PlyFormat::ascii) return {MeshFormat::ply, Reducer(file, lines).ply(header)};
  return {MeshFormat::ply, std::move(text)};
}

}  // namespace

MeshText read_mesh_text(const fs::path& file) {
  const std::string extension = lower_case(file.extension().string());
  const bool known = extension == ".obj" || extension == ".ply" || extension == ".stl" || extension == ".off";
  if (!known) fail(file, "has another extension; allowed: .obj, .ply, .stl or .off");
  std::string text = read_named_file(file);
  if (text.empty()) fail(file, "the file is empty; allowed: a mesh with faces");
  if (extension == ".obj") return {MeshFormat::obj, Reducer(file, LineReader(text)).obj()};
  if (extension == ".ply") return ply_text(file, std::move(text));
  if (extension == ".stl") return stl_text(file, std::move(text));
  return off_text(file, std::move(text));
}

}  // namespace hapbench
