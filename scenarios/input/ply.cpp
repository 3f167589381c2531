#include <fmt/format.h>

#include <cstdint>
#include <optional>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_formats.hpp"

/// PLY files: the triangles of a surface (read_ply), or points with normals (ply_points_in).
namespace hapbench {
namespace {

namespace fs = std::filesystem;

// ---- Header

enum class PlyFormat { ascii, little_endian, big_endian };

/// Precondition: the format is a binary one.
std::endian byte_order(PlyFormat format) {
  return format == PlyFormat::big_endian ? std::endian::big : std::endian::little;
}

/// Type of a number in a PLY file.
struct PlyType {
  enum class Kind { signed_integer, unsigned_integer, real };
  Kind kind;
  std::size_t size;  ///< in a binary file [bytes]
};

/// The declarations of a PLY file, as words with the number of their line.
struct PlyHeader {
  struct Declaration {
    std::size_t line = 0;
    Words words;
  };
  struct Element : Declaration {
    std::vector<Declaration> properties;
  };
  PlyFormat format = PlyFormat::ascii;
  std::size_t last_line = 0;
  std::vector<Element> elements;
};

std::optional<PlyFormat> format_of(const Words& words) {
  if (words.size() != 3 || words[2] != "1.0") return std::nullopt;
  if (words[1] == "ascii") return PlyFormat::ascii;
  if (words[1] == "binary_little_endian") return PlyFormat::little_endian;
  if (words[1] == "binary_big_endian") return PlyFormat::big_endian;
  return std::nullopt;
}

std::optional<PlyType> ply_type(std::string_view name) {
  using enum PlyType::Kind;
  constexpr struct {
    std::string_view name, alias;
    PlyType type;
  } kTypes[] = {{"char", "int8", {signed_integer, 1}},   {"uchar", "uint8", {unsigned_integer, 1}},
                {"short", "int16", {signed_integer, 2}}, {"ushort", "uint16", {unsigned_integer, 2}},
                {"int", "int32", {signed_integer, 4}},   {"uint", "uint32", {unsigned_integer, 4}},
                {"float", "float32", {real, 4}},         {"double", "float64", {real, 8}}};
  for (const auto& t : kTypes)
    if (name == t.name || name == t.alias) return t.type;
  return std::nullopt;
}

/// The next number of a binary file, which a double can always represent. Precondition: enough bytes are left.
double take_ply_number(ByteReader& reader, PlyType type) {
  switch (type.kind) {
    case PlyType::Kind::signed_integer:
      if (type.size == 1) return reader.take<std::int8_t>();
      return type.size == 2 ? reader.take<std::int16_t>() : reader.take<std::int32_t>();
    case PlyType::Kind::unsigned_integer:
      if (type.size == 1) return reader.take<std::uint8_t>();
      return type.size == 2 ? reader.take<std::uint16_t>() : reader.take<std::uint32_t>();
    case PlyType::Kind::real:
      return type.size == 4 ? reader.take<float>() : reader.take<double>();
  }
  return 0.0;
}

/// Reads from "ply" to "end_header". Throws InputError that names file and line.
PlyHeader read_ply_header(LineReader& lines, const fs::path& file) {
  PlyHeader header;
  std::optional<PlyFormat> format;
  const auto fail = [&](const std::string& problem) { fail_in_line(file, lines.line(), problem); };
  for (;;) {
    const auto line = lines.next();
    if (!line) fail("the header does not end; allowed: a PLY header up to \"end_header\"");
    const Words words = words_of(*line);
    const std::string_view first = words.empty() ? "" : words[0];
    if (lines.line() == 1) {
      if (words != Words{"ply"}) fail("is not a PLY file; allowed: \"ply\" as the first line");
    } else if (first == "end_header") {
      break;
    } else if (first == "format") {
      format = format_of(words);
      if (!format) fail("unknown format; allowed: ascii, binary_little_endian or binary_big_endian, 1.0");
    } else if (first == "element") {
      header.elements.push_back({{lines.line(), words}, {}});
    } else if (first == "property") {
      if (header.elements.empty()) fail("got a property before an element; allowed: after one");
      header.elements.back().properties.push_back({lines.line(), words});
    } else if (first != "comment" && first != "obj_info") {
      fail(
          fmt::format("got {}; allowed: format, comment, obj_info, element, property, end_header", quoted_word(first)));
    }
  }
  if (!format) fail("allowed: a header with \"format\"");
  header.format = *format;
  header.last_line = lines.line();
  return header;
}

// ---- Elements

/// The use of a property.
enum class Role : std::size_t { x, y, z, nx, ny, nz, corners, nothing };
/// The names of those of a vertex.
constexpr std::array<std::string_view, 6> kOfVertex = {"x", "y", "z", "nx", "ny", "nz"};

Role role_in_vertex(std::string_view name) {
  const auto found = std::find(kOfVertex.begin(), kOfVertex.end(), name);
  return found == kOfVertex.end() ? Role::nothing : static_cast<Role>(found - kOfVertex.begin());
}

struct Property {
  std::optional<PlyType> count;  ///< type of a list's length; none for a scalar
  PlyType type;
  Role role = Role::nothing;
};

struct Element {
  std::string_view name;
  std::size_t entries = 0;
  std::vector<Property> properties;

  bool is_vertex() const { return name == "vertex"; }
  bool is_face() const { return name == "face"; }
  auto count(Role role) const {
    return std::count_if(properties.begin(), properties.end(), [role](const Property& p) { return p.role == role; });
  }
};

/// The use of a file: a surface by its faces, or points by its vertices, which then have normals.
enum class Wanted { faces, points };

Property scalar(const PlyHeader::Declaration& declaration, bool of_vertex, Wanted wanted, const fs::path& file) {
  const Words& words = declaration.words;
  const auto type = words.size() == 3 ? ply_type(words[1]) : std::nullopt;
  if (!type)
    fail_in_line(file, declaration.line, "allowed: \"property TYPE NAME\" or \"property list COUNT TYPE NAME\"");
  const Role role = role_in_vertex(words[2]);
  if (!of_vertex || role > (wanted == Wanted::points ? Role::nz : Role::z)) return {{}, *type};
  if (wanted == Wanted::faces && type->kind != PlyType::Kind::real)
    fail_in_line(file, declaration.line, "allowed for a coordinate: float or double");
  return {{}, *type, role};
}

Property list(const PlyHeader::Declaration& declaration, bool of_face, const fs::path& file) {
  const Words& words = declaration.words;
  const auto count = words.size() == 5 ? ply_type(words[2]) : std::nullopt;
  const auto type = words.size() == 5 ? ply_type(words[3]) : std::nullopt;
  const bool corners = of_face && words.size() == 5 && (words[4] == "vertex_indices" || words[4] == "vertex_index");
  const bool counted = count && count->kind != PlyType::Kind::real;
  if (!counted || !type || (corners && type->kind == PlyType::Kind::real)) {
    fail_in_line(file, declaration.line,
                 "allowed: \"property list COUNT TYPE NAME\" with an integer type COUNT, for the vertices of a face "
                 "an integer TYPE, too");
  }
  return {count, *type, corners ? Role::corners : Role::nothing};
}

void require_points(const Element& vertices, const PlyHeader& header, const fs::path& file) {
  for (const std::string_view name : kOfVertex) {
    const auto count = vertices.count(role_in_vertex(name));
    if (count == 1) continue;
    fail_in_line(file, header.last_line,
                 fmt::format("got {} vertex properties \"{}\"; allowed: one each of x, y, z, nx, ny, nz", count, name));
  }
}

/// The elements up to those wanted. Later elements are not read.
std::vector<Element> elements_of(const PlyHeader& header, Wanted wanted, const fs::path& file) {
  std::vector<Element> elements;
  bool positions = false;
  for (const PlyHeader::Element& declared : header.elements) {
    const auto entries = declared.words.size() == 3 ? whole_number(declared.words[2]) : std::nullopt;
    if (!entries) fail_in_line(file, declared.line, "allowed: \"element NAME COUNT\"");
    Element element{declared.words[1], *entries, {}};
    for (const PlyHeader::Declaration& p : declared.properties) {
      const bool is_list = p.words.size() > 1 && p.words[1] == "list";
      element.properties.push_back(is_list ? list(p, element.is_face(), file)
                                           : scalar(p, element.is_vertex(), wanted, file));
    }
    if (element.is_vertex()) {
      const bool has_all = element.count(Role::x) == 1 && element.count(Role::y) == 1 && element.count(Role::z) == 1;
      positions = has_all && !positions;  // a second element of that name is refused too
    }
    elements.push_back(std::move(element));
    if (wanted == Wanted::points) {
      if (!elements.back().is_vertex()) continue;
      require_points(elements.back(), header, file);
      return elements;
    }
    if (!elements.back().is_face()) continue;
    if (elements.back().count(Role::corners) != 1)
      fail_in_line(file, declared.line, "allowed for a face: one \"property list COUNT INDEX vertex_indices\"");
    if (!positions) fail_in_line(file, declared.line, "allowed before the faces: vertices with one each of x, y and z");
    return elements;
  }
  fail_in_line(file, header.last_line,
               wanted == Wanted::points ? "has no vertices; allowed: \"element vertex COUNT\""
                                        : "has no faces; allowed: \"element face COUNT\"");
}

// ---- Entries

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
      need(length, p.type, element);
      if (p.role == Role::nothing)
        reader_.skip(length * p.type.size);
      else if (p.role == Role::corners)
        add_face(length, p.type);
      else
        values[static_cast<std::size_t>(p.role)] = take_ply_number(reader_, p.type);
    }
    if (element.is_vertex()) contents_.add_vertex(values, wanted_);
  }

  std::size_t list_length(const Element& element, const Property& property, std::size_t i) {
    need(1, *property.count, element);
    const double length = take_ply_number(reader_, *property.count);
    if (property.role == Role::corners && length < 3.0)
      fail_in_file(file_, fmt::format("face {}: got {} corners; allowed: at least 3", i, length));
    if (length < 0.0) {
      fail_in_file(file_, fmt::format("{} {}: got a list of {} entries; allowed: an integer from 0",
                                      quoted_word(element.name), i, length));
    }
    return static_cast<std::size_t>(length);
  }

  void add_face(std::size_t corners, PlyType type) {
    corners_.clear();
    for (std::size_t k = 0; k < corners; ++k) {
      const auto index = static_cast<std::int64_t>(take_ply_number(reader_, type));
      corners_.push_back(
          static_cast<std::uint32_t>(index));  // a negative index becomes too large and is refused as such
    }
    add_polygon(corners_, contents_.soup);
  }

  void need(std::size_t numbers, PlyType type, const Element& element) const {
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
  const PlyHeader header = read_ply_header(lines, file);
  const std::vector<Element> elements = elements_of(header, wanted, file);
  if (header.format == PlyFormat::ascii) return read_ply_text(elements, wanted, MeshLines(lines, file));
  return BinaryEntries(ByteReader(lines.rest(), byte_order(header.format)), wanted, file).read(elements);
}

}  // namespace

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
