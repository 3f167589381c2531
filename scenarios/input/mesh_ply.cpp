#include <fmt/format.h>

#include <algorithm>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_formats.hpp"
#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/ply_header.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// What a property is good for.
enum class Role { x, y, z, corners, nothing };

struct Property {
  std::optional<PlyType> count;  ///< of a list: how its length is stored
  PlyType type;
  Role role = Role::nothing;
};

struct Element {
  std::string_view name;
  std::size_t entries = 0;
  std::vector<Property> properties;

  bool is_vertex() const { return name == "vertex"; }
  bool is_face() const { return name == "face"; }
  bool has_once(Role role) const {
    return std::count_if(properties.begin(), properties.end(), [role](const Property& p) { return p.role == role; }) ==
           1;
  }
};

Property scalar(const PlyHeader::Declaration& declaration, bool of_vertex, const fs::path& file) {
  const Words& words = declaration.words;
  const auto type = words.size() == 3 ? ply_type(words[1]) : std::nullopt;
  if (!type)
    fail_in_line(file, declaration.line, "allowed: \"property TYPE NAME\" or \"property list COUNT TYPE NAME\"");
  const bool coordinate = of_vertex && (words[2] == "x" || words[2] == "y" || words[2] == "z");
  if (!coordinate) return {{}, *type};
  if (type->kind != PlyType::Kind::real)
    fail_in_line(file, declaration.line, "allowed for a coordinate: float or double");
  return {{}, *type, static_cast<Role>(words[2][0] - 'x')};
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

/// The elements up to the faces; those behind them are not read.
std::vector<Element> elements_of(const PlyHeader& header, const fs::path& file) {
  std::vector<Element> elements;
  bool positions = false;
  for (const PlyHeader::Element& declared : header.elements) {
    const auto entries = declared.words.size() == 3 ? whole_number(declared.words[2]) : std::nullopt;
    if (!entries) fail_in_line(file, declared.line, "allowed: \"element NAME COUNT\"");
    Element element{declared.words[1], *entries, {}};
    for (const PlyHeader::Declaration& p : declared.properties) {
      const bool is_list = p.words.size() > 1 && p.words[1] == "list";
      element.properties.push_back(is_list ? list(p, element.is_face(), file) : scalar(p, element.is_vertex(), file));
    }
    if (element.is_vertex()) {
      const bool has_all = element.has_once(Role::x) && element.has_once(Role::y) && element.has_once(Role::z);
      positions = has_all && !positions;  // a second element of that name is refused, too
    }
    elements.push_back(std::move(element));
    if (!elements.back().is_face()) continue;
    if (!elements.back().has_once(Role::corners))
      fail_in_line(file, declared.line, "allowed for a face: one \"property list COUNT INDEX vertex_indices\"");
    if (!positions) fail_in_line(file, declared.line, "allowed before the faces: vertices with one each of x, y and z");
    return elements;
  }
  fail_in_line(file, header.last_line, "has no faces; allowed: \"element face COUNT\"");
}

/// In a text, each vertex and each face has a line; what stands behind the position or the corners is left out.
TriangleSoup read_text(const std::vector<Element>& elements, MeshLines lines) {
  TriangleSoup soup;
  const auto add_vertex = [&](const Element& element) {
    Vec3 position;
    std::size_t word = 0;
    for (const Property& p : element.properties) {
      const std::size_t length = p.count ? 1 + lines.count(word, "entries") : 1;
      if (lines.words().size() < word + length) {
        lines.fail(
            fmt::format("got {} values; allowed: the {} of a vertex", lines.words().size(), element.properties.size()));
      }
      if (p.role != Role::nothing) position[static_cast<int>(p.role)] = lines.number(word);
      word += length;
    }
    soup.vertices.push_back(position);
  };
  const auto add_face = [&](const Element& element, std::size_t i) {
    std::size_t word = 0;
    for (const Property& p : element.properties) {
      if (p.role == Role::corners) return lines.add_face(i, word, soup);
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
  return soup;
}

/// Takes the entries of a binary file's elements one by one.
class BinaryEntries {
 public:
  BinaryEntries(ByteReader reader, const fs::path& file) : reader_(reader), file_(file) {}

  TriangleSoup read(const std::vector<Element>& elements) {
    for (const Element& element : elements) {
      for (std::size_t i = 0; i < element.entries && !element.properties.empty(); ++i) read_entry(element, i);
    }
    return std::move(soup_);
  }

 private:
  void read_entry(const Element& element, std::size_t i) {
    Vec3 position;
    for (const Property& p : element.properties) {
      const std::size_t length = p.count ? list_length(element, p, i) : 1;
      need(length, p.type, element);
      if (p.role == Role::nothing) {
        reader_.skip(length * p.type.size);
      } else if (p.role == Role::corners) {
        add_face(length, p.type);
      } else {
        position[static_cast<int>(p.role)] = take_ply_number(reader_, p.type);
      }
    }
    if (element.is_vertex()) soup_.vertices.push_back(position);
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
      corners_.push_back(static_cast<std::uint32_t>(index));  // a negative one is too large then, and refused as such
    }
    add_polygon(corners_, soup_);
  }

  void need(std::size_t numbers, PlyType type, const Element& element) const {
    if (reader_.left() / type.size >= numbers) return;
    fail_in_file(file_, fmt::format("the file ends before its {} {}; allowed: a complete file", element.entries,
                                    quoted_word(element.name)));
  }

  ByteReader reader_;
  const fs::path& file_;
  TriangleSoup soup_;
  std::vector<std::uint32_t> corners_;  ///< of the face at hand
};

}  // namespace

TriangleSoup read_ply(std::string_view text, const fs::path& file) {
  LineReader lines(text);
  const PlyHeader header = read_ply_header(lines, file);
  const std::vector<Element> elements = elements_of(header, file);
  if (header.format == PlyFormat::ascii) return read_text(elements, MeshLines(lines, file));
  return BinaryEntries(ByteReader(lines.rest(), byte_order(header.format)), file).read(elements);
}

}  // namespace hapbench
