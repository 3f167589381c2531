#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "scenarios/format/input_error.hpp"
#include "scenarios/format/mesh_file.hpp"
#include "scenarios/format/text_lines.hpp"

/// Files come from outside: each word is checked, and memory grows with what a file holds, never with what it declares.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Cuts a polygon into a fan of triangles from its first corner.
void add_polygon(std::span<const std::uint32_t> corners, TriangleSoup& soup) {
  for (std::size_t i = 2; i < corners.size(); ++i) soup.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

/// The lines of a mesh file in text form, each as its words. Comments (from '#' to the end of the line) and blank lines
/// are skipped. Every function throws an InputError that names file and line when a word is not what it should be.
class MeshLines {
 public:
  MeshLines(LineReader lines, const fs::path& file) : lines_(lines), file_(file) {}

  /// Goes to the next line that has words; false at the end of the text.
  bool next() {
    while (const auto line = lines_.next()) {
      words_ = words_of(line->substr(0, line->find('#')));
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }
  const Words& words() const { return words_; }

  /// The word as a finite number. Precondition: there is such a word.
  double number(std::size_t word) const {
    std::string_view text = words_[word];
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    const auto value = finite_number(text);
    if (!value) fail("got " + quoted_word(text) + "; allowed: a finite number");
    return *value;
  }
  /// Three coordinates from that word on.
  Vec3 position(std::size_t first) const {
    if (words_.size() < first + 3) fail(fmt::format("got {} coordinates; allowed: 3", words_.size() - first));
    const double x = number(first), y = number(first + 1), z = number(first + 2);
    return {x, y, z};
  }
  /// The word as a count or an index, within 31 bits; `what` it counts is for the message.
  std::size_t count(std::size_t word, const char* what) const {
    const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
    if (number && *number <= std::numeric_limits<std::int32_t>::max()) return *number;
    fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted_word(words_[word]) : "no",
                     what));
  }
  /// Adds face `index` of the file, described by the words from `first` on: the number of corners, then their vertices.
  void add_face(std::size_t index, std::size_t first, TriangleSoup& soup) const {
    const std::size_t corners = count(first, "corners");
    if (corners < 3 || words_.size() <= first + corners)
      fail(fmt::format("face {}: got {} corners; allowed: at least 3, and as many vertices", index, corners));
    std::vector<std::uint32_t> vertices;
    vertices.reserve(corners);
    for (std::size_t k = 1; k <= corners; ++k)
      vertices.push_back(static_cast<std::uint32_t>(count(first + k, "as a vertex")));
    add_polygon(vertices, soup);
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(file_, lines_.line(), problem); }

 private:
  LineReader lines_;
  const fs::path& file_;
  Words words_;  ///< of the current line
};

/// Takes the numbers of a binary file one after another. The bytes must outlive it.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::endian order) : bytes_(bytes), order_(order) {}

  /// Number of bytes that have not been taken yet.
  std::size_t left() const { return bytes_.size(); }
  void skip(std::size_t bytes) { bytes_.remove_prefix(bytes); }

  /// Precondition: at least sizeof(T) bytes are left.
  template <class T>
  T take() {
    std::array<char, sizeof(T)> number;
    std::copy_n(bytes_.begin(), sizeof(T), number.begin());
    bytes_.remove_prefix(sizeof(T));
    if (order_ != std::endian::native) std::reverse(number.begin(), number.end());
    return std::bit_cast<T>(number);
  }

 private:
  std::string_view bytes_;
  std::endian order_;
};

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
                      quoted_word(lines.words()[0])));
    }
  }
  return soup;
}

TriangleSoup read_stl_binary(ByteReader reader, std::size_t triangles, const fs::path& file) {
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

// ---- PLY: the triangles of a surface, or points with normals

/// A type of numbers in a PLY file.
struct PlyType {
  std::string_view name, alias;
  std::size_t size;  ///< in a binary file [bytes]
  bool is_real;
  /// The next number of a binary file, which a double can always represent. Precondition: enough bytes are left.
  double (*take)(ByteReader& reader);
};

template <class T>
constexpr PlyType type_named(std::string_view name, std::string_view alias) {
  return {name, alias, sizeof(T), std::is_floating_point_v<T>,
          [](ByteReader& reader) -> double { return reader.take<T>(); }};
}
constexpr PlyType kPlyTypes[] = {
    type_named<std::int8_t>("char", "int8"),    type_named<std::uint8_t>("uchar", "uint8"),
    type_named<std::int16_t>("short", "int16"), type_named<std::uint16_t>("ushort", "uint16"),
    type_named<std::int32_t>("int", "int32"),   type_named<std::uint32_t>("uint", "uint32"),
    type_named<float>("float", "float32"),      type_named<double>("double", "float64")};

/// Null for a name that is none.
const PlyType* ply_type(std::string_view name) {
  const auto is_named = [name](const PlyType& type) { return name == type.name || name == type.alias; };
  const auto* found = std::find_if(std::begin(kPlyTypes), std::end(kPlyTypes), is_named);
  return found == std::end(kPlyTypes) ? nullptr : found;
}

/// The use of a property.
enum class Role : std::size_t { x, y, z, nx, ny, nz, corners, nothing };
/// The names of those of a vertex.
constexpr std::array<std::string_view, 6> kOfVertex = {"x", "y", "z", "nx", "ny", "nz"};

Role role_in_vertex(std::string_view name) {
  const auto found = std::find(kOfVertex.begin(), kOfVertex.end(), name);
  return found == kOfVertex.end() ? Role::nothing : static_cast<Role>(found - kOfVertex.begin());
}

struct Property {
  const PlyType* count;  ///< type of a list's length; null for a scalar
  const PlyType* type;
  Role role = Role::nothing;
};

struct Element {
  std::string_view name;
  std::size_t line = 0;  ///< of its declaration
  std::size_t entries = 0;
  std::vector<Property> properties = {};

  bool is_vertex() const { return name == "vertex"; }
  bool is_face() const { return name == "face"; }
  auto count(Role role) const {
    return std::count_if(properties.begin(), properties.end(), [role](const Property& p) { return p.role == role; });
  }
};

/// The use of a file: a surface by its faces, or points by its vertices, which then have normals.
enum class Wanted { faces, points };

/// Reads the header of a PLY file, from "ply" to "end_header". Throws InputError that names file and line.
class PlyHeader {
 public:
  PlyHeader(LineReader& lines, Wanted wanted, const fs::path& file) : lines_(lines), wanted_(wanted), file_(file) {
    while (read_line()) {
    }
    if (!format_) fail("allowed: a header with \"format\"");
    check();
  }

  /// The elements up to those wanted; later ones are not read.
  const std::vector<Element>& elements() const { return elements_; }
  bool is_text() const { return format_ == "ascii"; }
  /// The byte order of the numbers. Precondition: not is_text().
  std::endian byte_order() const { return format_ == "binary_big_endian" ? std::endian::big : std::endian::little; }

 private:
  /// False at the end of the header.
  bool read_line() {
    const auto line = lines_.next();
    if (!line) fail("the header does not end; allowed: a PLY header up to \"end_header\"");
    const Words words = words_of(*line);
    const std::string_view first = words.empty() ? "" : words[0];
    if (lines_.line() == 1) {
      if (words != Words{"ply"}) fail("is not a PLY file; allowed: \"ply\" as the first line");
    } else if (first == "end_header") {
      return false;
    } else if (first == "format") {
      read_format(words);
    } else if (first == "element") {
      if (!has_wanted()) add_element(words);
      is_after_wanted_ = elements_.back().line != lines_.line();
    } else if (first == "property") {
      if (elements_.empty()) fail("got a property before an element; allowed: after one");
      if (!is_after_wanted_) add_property(words, elements_.back());
    } else if (first != "comment" && first != "obj_info") {
      fail(
          fmt::format("got {}; allowed: format, comment, obj_info, element, property, end_header", quoted_word(first)));
    }
    return true;
  }

  void read_format(const Words& words) {
    constexpr std::array<std::string_view, 3> kFormats = {"ascii", "binary_little_endian", "binary_big_endian"};
    const bool is_known = words.size() == 3 && words[2] == "1.0" &&
                          std::find(kFormats.begin(), kFormats.end(), words[1]) != kFormats.end();
    if (!is_known) fail("unknown format; allowed: ascii, binary_little_endian or binary_big_endian, 1.0");
    format_ = words[1];
  }

  bool has_wanted() const {
    return !elements_.empty() &&
           (wanted_ == Wanted::points ? elements_.back().is_vertex() : elements_.back().is_face());
  }

  void add_element(const Words& words) {
    const auto entries = words.size() == 3 ? whole_number(words[2]) : std::nullopt;
    if (!entries) fail("allowed: \"element NAME COUNT\"");
    elements_.push_back({words[1], lines_.line(), *entries});
  }

  void add_property(const Words& words, Element& element) const {
    const bool is_list = words.size() > 1 && words[1] == "list";
    element.properties.push_back(is_list ? list(words, element.is_face()) : scalar(words, element.is_vertex()));
  }

  Property scalar(const Words& words, bool of_vertex) const {
    const PlyType* type = words.size() == 3 ? ply_type(words[1]) : nullptr;
    if (type == nullptr) fail("allowed: \"property TYPE NAME\" or \"property list COUNT TYPE NAME\"");
    const Role role = role_in_vertex(words[2]);
    if (!of_vertex || role > (wanted_ == Wanted::points ? Role::nz : Role::z)) return {nullptr, type};
    if (wanted_ == Wanted::faces && !type->is_real) fail("allowed for a coordinate: float or double");
    return {nullptr, type, role};
  }

  Property list(const Words& words, bool of_face) const {
    const PlyType* count = words.size() == 5 ? ply_type(words[2]) : nullptr;
    const PlyType* type = words.size() == 5 ? ply_type(words[3]) : nullptr;
    const bool corners = of_face && words.size() == 5 && (words[4] == "vertex_indices" || words[4] == "vertex_index");
    if (count == nullptr || type == nullptr || count->is_real || (corners && type->is_real)) {
      fail(
          "allowed: \"property list COUNT TYPE NAME\" with an integer type COUNT, for the vertices of a face an integer "
          "TYPE, too");
    }
    return {count, type, corners ? Role::corners : Role::nothing};
  }

  void check() const {
    if (!has_wanted()) {
      fail(wanted_ == Wanted::points ? "has no vertices; allowed: \"element vertex COUNT\""
                                     : "has no faces; allowed: \"element face COUNT\"");
    }
    return wanted_ == Wanted::points ? check_points(elements_.back()) : check_faces(elements_.back());
  }

  void check_points(const Element& vertices) const {
    for (const std::string_view name : kOfVertex) {
      if (const auto count = vertices.count(role_in_vertex(name)); count != 1)
        fail(fmt::format("got {} vertex properties \"{}\"; allowed: one each of x, y, z, nx, ny, nz", count, name));
    }
  }

  void check_faces(const Element& faces) const {
    if (faces.count(Role::corners) != 1)
      fail_in_line(file_, faces.line, "allowed for a face: one \"property list COUNT INDEX vertex_indices\"");
    std::size_t vertices = 0, with_position = 0;
    for (const Element& element : elements_) {
      if (!element.is_vertex()) continue;
      ++vertices;
      with_position += element.count(Role::x) == 1 && element.count(Role::y) == 1 && element.count(Role::z) == 1;
    }
    if (vertices != 1 || with_position != 1)
      fail_in_line(file_, faces.line, "allowed before the faces: vertices with one each of x, y and z");
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(file_, lines_.line(), problem); }

  LineReader& lines_;
  Wanted wanted_;
  const fs::path& file_;
  std::optional<std::string_view> format_;
  std::vector<Element> elements_;
  bool is_after_wanted_ = false;
};

/// The values of a vertex by their role; 0 for those that are not read.
using Values = std::array<double, kOfVertex.size()>;

struct Contents {
  TriangleSoup soup;
  std::vector<Vec3> normals;  ///< of the vertices, where points are wanted

  void add_vertex(const Values& v, Wanted wanted) {
    soup.vertices.emplace_back(v[0], v[1], v[2]);
    if (wanted == Wanted::points) normals.emplace_back(v[3], v[4], v[5]);
  }
};

/// Reads a text, in which each vertex and each face has a line. Values after the position or the corners are ignored.
Contents read_ply_text(const std::vector<Element>& elements, Wanted wanted, MeshLines lines) {
  Contents contents;
  const auto add_vertex = [&](const Element& element) {
    Values values{};
    std::size_t word = 0;
    for (const Property& p : element.properties) {
      const std::size_t length = p.count ? 1 + lines.count(word, "entries") : 1;
      if (lines.words().size() < word + length)
        lines.fail(
            fmt::format("got {} values; allowed: the {} of a vertex", lines.words().size(), element.properties.size()));
      if (p.role != Role::nothing) values[static_cast<std::size_t>(p.role)] = lines.number(word);
      word += length;
    }
    contents.add_vertex(values, wanted);
  };
  const auto add_face = [&](const Element& element, std::size_t i) {
    std::size_t word = 0;
    for (const Property& p : element.properties) {
      if (p.role == Role::corners) return lines.add_face(i, word, contents.soup);
      word += p.count ? 1 + lines.count(word, "entries") : 1;
    }
  };
  for (const Element& element : elements) {
    for (std::size_t i = 0; i < element.entries && !element.properties.empty(); ++i) {
      if (!lines.next()) {
        lines.fail(fmt::format("the file ends before its {} {}; allowed: a complete file", element.entries,
                               quoted_word(element.name)));
      }
      if (element.is_vertex()) add_vertex(element);
      if (element.is_face()) add_face(element, i);
    }
  }
  return contents;
}

/// Reads the elements of a binary file entry by entry.
class BinaryEntries {
 public:
  BinaryEntries(ByteReader reader, Wanted wanted, const fs::path& file)
      : reader_(reader), wanted_(wanted), file_(file) {}

  Contents read(const std::vector<Element>& elements) {
    for (const Element& element : elements)
      for (std::size_t i = 0; i < element.entries && !element.properties.empty(); ++i) read_entry(element, i);
    return std::move(contents_);
  }

 private:
  void read_entry(const Element& element, std::size_t i) {
    Values values{};
    for (const Property& p : element.properties) {
      const std::size_t length = p.count ? list_length(element, p, i) : 1;
      need(length, *p.type, element);
      if (p.role == Role::nothing)
        reader_.skip(length * p.type->size);
      else if (p.role == Role::corners)
        add_face(length, *p.type);
      else
        values[static_cast<std::size_t>(p.role)] = p.type->take(reader_);
    }
    if (element.is_vertex()) contents_.add_vertex(values, wanted_);
  }

  std::size_t list_length(const Element& element, const Property& property, std::size_t i) {
    need(1, *property.count, element);
    const double length = property.count->take(reader_);
    if (property.role == Role::corners && length < 3.0)
      fail_in_file(file_, fmt::format("face {}: got {} corners; allowed: at least 3", i, length));
    if (length < 0.0) {
      fail_in_file(file_, fmt::format("{} {}: got a list of {} entries; allowed: an integer from 0",
                                      quoted_word(element.name), i, length));
    }
    return static_cast<std::size_t>(length);
  }

  void add_face(std::size_t corners, const PlyType& type) {
    corners_.clear();
    for (std::size_t k = 0; k < corners; ++k) {
      const auto index = static_cast<std::int64_t>(type.take(reader_));
      corners_.push_back(
          static_cast<std::uint32_t>(index));  // a negative index becomes too large and is refused as such
    }
    add_polygon(corners_, contents_.soup);
  }

  void need(std::size_t numbers, const PlyType& type, const Element& element) const {
    if (reader_.left() / type.size >= numbers) return;
    fail_in_file(file_, fmt::format("the file ends before its {} {}; allowed: a complete file", element.entries,
                                    quoted_word(element.name)));
  }

  ByteReader reader_;
  Wanted wanted_;
  const fs::path& file_;
  Contents contents_;
  std::vector<std::uint32_t> corners_;  ///< of the current face
};

Contents contents_of(std::string_view text, Wanted wanted, const fs::path& file) {
  LineReader lines(text);
  const PlyHeader header(lines, wanted, file);
  if (header.is_text()) return read_ply_text(header.elements(), wanted, MeshLines(lines, file));
  return BinaryEntries(ByteReader(lines.rest(), header.byte_order()), wanted, file).read(header.elements());
}

}  // namespace

TriangleSoup read_obj(std::string_view text, const fs::path& file) {
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

TriangleSoup read_stl(std::string_view text, const fs::path& file) {
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

TriangleSoup read_ply(std::string_view text, const fs::path& file) {
  return contents_of(text, Wanted::faces, file).soup;
}

std::vector<SurfacePoint> ply_points_in(std::string_view text, const fs::path& file) {
  const Contents contents = contents_of(text, Wanted::points, file);
  std::vector<SurfacePoint> points;
  points.reserve(contents.normals.size());
  for (std::size_t i = 0; i < contents.normals.size(); ++i)
    points.push_back({contents.soup.vertices[i], contents.normals[i]});
  return points;
}

}  // namespace hapbench
