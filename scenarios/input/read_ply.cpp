#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/text_lines.hpp"

/// Files come from outside: each word is checked, and memory grows with what a file holds, never with what it declares.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Cuts a polygon into a fan of triangles from its first corner. `corner(k)` gives the next vertex, the k-th.
template <class Corner>
void add_polygon(std::size_t corners, TriangleSoup& soup, Corner corner) {
  const std::uint32_t first = corner(0);
  std::uint32_t last = corner(1);
  for (std::size_t k = 2; k < corners; ++k) {
    const std::uint32_t next = corner(k);
    soup.triangles.push_back({first, last, next});
    last = next;
  }
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
    return {number(first), number(first + 1), number(first + 2)};
  }
  /// The word as a count or an index, within 31 bits; `what` it counts is for the message.
  std::size_t count(std::size_t word, const char* what) const {
    const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
    if (number && *number <= std::numeric_limits<std::int32_t>::max()) return *number;
    fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted_word(words_[word]) : "no",
                     what));
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

/// Index of the vertex that a face's corner names: "7/1/3" the file's seventh, "-1" the last of the `vertices` so far.
std::uint32_t vertex_of(std::string_view word, std::size_t vertices, const MeshLines& lines) {
  const auto index = whole_word_as<int>(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  if (!index || *index == 0 || *index < -count) {
    lines.fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one",
                           quoted_word(word)));
  }
  return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
}

// ---- OFF

/// Reads what follows the header's keyword. What comes after a position or corners, as normals or colours, is ignored.
TriangleSoup read_off_text(MeshLines& lines) {
  // The counts may stand in the line of the header.
  const std::size_t counts = lines.words().size() > 1 ? 1 : 0;
  if (counts == 0 && !lines.next()) lines.fail("the file ends before its counts of vertices, faces and edges");
  const std::size_t vertices = lines.count(counts, "vertices"), faces = lines.count(counts + 1, "faces");
  const auto next = [&lines](std::size_t count, const char* what) {
    if (!lines.next()) lines.fail(fmt::format("the file ends before its {} {}; allowed: a complete file", count, what));
  };
  TriangleSoup soup;
  for (std::size_t i = 0; i < vertices; ++i) {
    next(vertices, "vertices");
    soup.vertices.push_back(lines.position(0));
  }
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

/// The numbers of a vertex. The role of a property is the place of one of them, or one of those below.
constexpr std::array<std::string_view, 6> kOfVertex = {"x", "y", "z", "nx", "ny", "nz"};
constexpr std::size_t kCorners = 6, kNothing = 7;
using Values = std::array<double, kOfVertex.size()>;

struct Property {
  const PlyType* count;  ///< type of a list's length; null for a scalar
  const PlyType* type;
  std::size_t role = kNothing;
};

struct Element {
  std::string_view name;
  std::size_t line = 0;  ///< of its declaration
  std::size_t entries = 0;
  std::vector<Property> properties = {};

  bool is_vertex() const { return name == "vertex"; }
  auto count(std::size_t role) const { return std::ranges::count(properties, role, &Property::role); }
};

/// The use of a file: a surface by its faces, or points by its vertices, which then have normals.
enum class Wanted { faces, points };

/// Reads the header of a PLY file, from "ply" to "end_header". Throws InputError that names file and line.
class PlyHeader {
 public:
  PlyHeader(LineReader& lines, Wanted wanted, const fs::path& file)
      : lines_(lines), numbers_(wanted == Wanted::points ? 6 : 3), file_(file) {
    while (read_line()) {
    }
    if (!format_) fail("allowed: a header with \"format\"");
    const std::string_view name = wanted == Wanted::points ? "vertex" : "face";
    const auto last = std::ranges::find(elements_, name, &Element::name);
    if (last == elements_.end()) fail(fmt::format("has no {}; allowed: \"element {} COUNT\"", name, name));
    elements_.erase(last + 1, elements_.end());
    check_vertices();
    if (wanted == Wanted::faces && elements_.back().count(kCorners) != 1) {
      fail_in_line(file_, elements_.back().line,
                   "allowed for a face: one \"property list COUNT INDEX vertex_indices\"");
    }
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
      const auto entries = words.size() == 3 ? whole_number(words[2]) : std::nullopt;
      if (!entries) fail("allowed: \"element NAME COUNT\"");
      elements_.push_back({words[1], lines_.line(), *entries});
    } else if (first == "property") {
      if (elements_.empty()) fail("got a property before an element; allowed: after one");
      elements_.back().properties.push_back(property(words));
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

  /// A scalar, "property TYPE NAME", or a list, "property list COUNT TYPE NAME". A role is that of the last element.
  Property property(const Words& words) const {
    const bool is_list = words.size() == 5 && words[1] == "list";
    const PlyType* count = is_list ? ply_type(words[2]) : nullptr;
    const PlyType* type = is_list || words.size() == 3 ? ply_type(words[words.size() - 2]) : nullptr;
    if (type == nullptr || (is_list && (count == nullptr || count->is_real)))
      fail("allowed: \"property TYPE NAME\" or, with an integer COUNT, \"property list COUNT TYPE NAME\"");
    const std::string_view name = words.back();
    if (!is_list) {
      const auto role = static_cast<std::size_t>(std::ranges::find(kOfVertex, name) - kOfVertex.begin());
      return {nullptr, type, elements_.back().is_vertex() && role < numbers_ ? role : kNothing};
    }
    const bool has_corners = elements_.back().name == "face" && (name == "vertex_indices" || name == "vertex_index");
    if (has_corners && type->is_real) fail("allowed for the vertices of a face: an integer type");
    return {count, type, has_corners ? kCorners : kNothing};
  }

  void check_vertices() const {
    for (const Element& element : elements_) {
      if (!element.is_vertex()) continue;
      for (std::size_t i = 0; i < numbers_; ++i) {
        if (element.count(i) == 1) continue;
        fail(fmt::format("got {} vertex properties \"{}\"; allowed: one each of {}", element.count(i), kOfVertex[i],
                         fmt::join(kOfVertex.begin(), kOfVertex.begin() + numbers_, ", ")));
      }
    }
    if (std::ranges::none_of(elements_, &Element::is_vertex)) fail("allowed before the faces: vertices");
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(file_, lines_.line(), problem); }

  LineReader& lines_;
  std::size_t numbers_;  ///< of a vertex that are read: its place, or also its normal
  const fs::path& file_;
  std::optional<std::string_view> format_;
  std::vector<Element> elements_;
};

/// The values of a PLY file's entries in order: words of a text, a line for each entry, or numbers of a binary file.
class PlyValues {
 public:
  PlyValues(const LineReader& lines, const PlyHeader& header, const fs::path& file)
      : is_text_(header.is_text()), text_(lines, file), bytes_(lines.rest(), header.byte_order()), file_(file) {}

  /// Goes to the next entry, which is one of `element`.
  void begin(const Element& element) {
    element_ = &element;
    word_ = 0;
    if (is_text_ && !text_.next()) fail_cut_short();
  }
  double number(const PlyType& type) {
    if (!is_text_) return take(type);
    skip(1, type);
    return text_.number(word_ - 1);
  }
  /// A count or an index; `what` it counts is for the message.
  std::int64_t whole(const PlyType& type, const char* what) {
    return is_text_ ? static_cast<std::int64_t>(text_.count(word_++, what)) : static_cast<std::int64_t>(take(type));
  }
  void skip(std::size_t numbers, const PlyType& type) {
    const std::size_t left = is_text_ ? text_.words().size() - word_ : bytes_.left() / type.size;
    if (left < numbers) fail_cut_short();
    if (is_text_)
      word_ += numbers;
    else
      bytes_.skip(numbers * type.size);
  }

  [[noreturn]] void fail(const std::string& problem) const {
    if (is_text_) text_.fail(problem);
    fail_in_file(file_, problem);
  }

 private:
  double take(const PlyType& type) {
    if (bytes_.left() < type.size) fail_cut_short();
    return type.take(bytes_);
  }
  [[noreturn]] void fail_cut_short() const {
    if (is_text_ && !text_.words().empty())
      text_.fail(fmt::format("got {} values; allowed: all of a {}", text_.words().size(), quoted_word(element_->name)));
    fail(fmt::format("the file ends before its {} {}; allowed: a complete file", element_->entries,
                     quoted_word(element_->name)));
  }

  bool is_text_;
  MeshLines text_;
  std::size_t word_ = 0;  ///< of the text's line, to be taken next
  ByteReader bytes_;
  const Element* element_ = nullptr;
  const fs::path& file_;
};

struct Contents {
  Wanted wanted;
  TriangleSoup soup = {};
  std::vector<SurfacePoint> points = {};  ///< instead of the vertices
};

/// Reads an entry, whose number is `i`.
void read_entry(const Element& element, std::size_t i, PlyValues& values, Contents& contents) {
  values.begin(element);
  Values vertex{};
  for (const Property& p : element.properties) {
    const std::int64_t length = p.count ? values.whole(*p.count, "entries") : 1;
    if (p.role == kCorners && length < 3)
      values.fail(fmt::format("face {}: got {} corners; allowed: at least 3", i, length));
    if (length < 0) {
      values.fail(fmt::format("{} {}: got a list of {} entries; allowed: an integer from 0", quoted_word(element.name),
                              i, length));
    }
    if (p.role == kNothing) {
      values.skip(static_cast<std::size_t>(length), *p.type);
    } else if (p.role == kCorners) {
      // A negative index of a binary file becomes too large and is refused as such.
      add_polygon(static_cast<std::size_t>(length), contents.soup,
                  [&](std::size_t) { return static_cast<std::uint32_t>(values.whole(*p.type, "as a vertex")); });
    } else {
      vertex[p.role] = values.number(*p.type);
    }
  }
  if (!element.is_vertex()) return;
  const Vec3 position(vertex[0], vertex[1], vertex[2]);
  if (contents.wanted == Wanted::points)
    contents.points.push_back({position, {vertex[3], vertex[4], vertex[5]}});
  else
    contents.soup.vertices.push_back(position);
}

Contents contents_of(std::string_view text, Wanted wanted, const fs::path& file) {
  LineReader lines(text);
  const PlyHeader header(lines, wanted, file);
  PlyValues values(lines, header, file);
  Contents contents{wanted};
  for (const Element& element : header.elements())
    for (std::size_t i = 0; i < element.entries && !element.properties.empty(); ++i)
      read_entry(element, i, values, contents);
  return contents;
}

}  // namespace

TriangleSoup read_obj(std::string_view text, const fs::path& file) {
  TriangleSoup soup;
  MeshLines lines{LineReader(text), file};
  while (lines.next()) {
    const Words& words = lines.words();
    if (words[0] == "v") {
      soup.vertices.push_back(lines.position(1));
    } else if (words[0] == "f") {
      if (words.size() < 4)
        lines.fail(fmt::format("got a face with {} corners; allowed: at least 3", words.size() - 1));
      add_polygon(words.size() - 1, soup,
                  [&](std::size_t k) { return vertex_of(words[k + 1], soup.vertices.size(), lines); });
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
                 "is not an STL file, or cut short; allowed: \"solid\" and text, or 84 bytes and 50 for each triangle");
  return read_stl_binary(reader, triangles, file);
}

TriangleSoup read_ply(std::string_view text, const fs::path& file) {
  return contents_of(text, Wanted::faces, file).soup;
}

std::vector<SurfacePoint> ply_points_in(std::string_view text, const fs::path& file) {
  return contents_of(text, Wanted::points, file).points;
}

}  // namespace hapbench
