#include "scenarios/input/read_ply.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A numeric type of PLY files.
struct PlyType {
  std::string_view name, alias;
  std::size_t size;  ///< size of a number in a binary file [bytes]
  bool is_real;      ///< true for a floating-point type
  double min, max;   ///< smallest and largest number of an integer type
  /// Reads the next number of a binary file. A double represents every PLY number exactly. Precondition: at least
  /// `size` bytes are left.
  double (*take)(ByteReader& reader);
};

/// Returns the PLY type of C++ type T, with its two names.
template <class T>
constexpr PlyType type_named(std::string_view name, std::string_view alias) {
  return {name,
          alias,
          sizeof(T),
          std::is_floating_point_v<T>,
          std::numeric_limits<T>::lowest(),
          std::numeric_limits<T>::max(),
          [](ByteReader& reader) -> double { return reader.take<T>(); }};
}
constexpr PlyType kPlyTypes[] = {
    type_named<std::int8_t>("char", "int8"),    type_named<std::uint8_t>("uchar", "uint8"),
    type_named<std::int16_t>("short", "int16"), type_named<std::uint16_t>("ushort", "uint16"),
    type_named<std::int32_t>("int", "int32"),   type_named<std::uint32_t>("uint", "uint32"),
    type_named<float>("float", "float32"),      type_named<double>("double", "float64")};

/// Returns the type with this name; null if no type has this name.
const PlyType* ply_type(std::string_view name) {
  const auto is_named = [name](const PlyType& type) { return name == type.name || name == type.alias; };
  const auto* found = std::find_if(std::begin(kPlyTypes), std::end(kPlyTypes), is_named);
  return found == std::end(kPlyTypes) ? nullptr : found;
}

/// Names of the vertex properties that are read. Each property has a role, which is a number. The role of a property in
/// this list is its index in the list. The role of every other property is kCorners or kIgnored.
constexpr std::array<std::string_view, 6> kVertexProperties = {"x", "y", "z", "nx", "ny", "nz"};
constexpr std::size_t kCorners = 6;  ///< role of a list with the vertex indices of a face
constexpr std::size_t kIgnored = 7;  ///< role of every other property
/// Values of the properties in kVertexProperties for one vertex.
using Values = std::array<double, kVertexProperties.size()>;

/// A property of an element: a number or a list of numbers.
struct Property {
  const PlyType* count;         ///< type of a list's length; null for a scalar
  const PlyType* type;          ///< type of the number or of the list's entries
  std::size_t role = kIgnored;  ///< index in kVertexProperties, kCorners or kIgnored
};

/// An element of the header, such as "vertex" or "face": a table with `entries` entries.
struct Element {
  std::string_view name;
  std::size_t line = 0;  ///< line of its declaration in the file
  std::size_t entries = 0;
  std::vector<Property> properties = {};

  bool is_vertex() const { return name == "vertex"; }
  /// Returns the number of properties whose role is `role`.
  auto count(std::size_t role) const { return std::ranges::count(properties, role, &Property::role); }
};

/// Content that is read from a file: a surface (faces), or points with normals (vertices only).
enum class Wanted { faces, points };

/// Parses the header of a PLY file, from "ply" to "end_header". Throws InputError that names file and line.
class PlyHeader {
 public:
  PlyHeader(LineReader& lines, Wanted wanted, const fs::path& file)
      : lines_(lines), numbers_(wanted == Wanted::points ? 6 : 3), file_(file) {
    // Parse all lines of the header.
    while (read_line()) {
    }
    if (!format_) fail("allowed: a header with \"format\"");
    // Drop the elements after the last element that is needed.
    const std::string_view name = wanted == Wanted::points ? "vertex" : "face";
    if (std::ranges::find(elements_, name, &Element::name) == elements_.end()) {
      const bool has_strips = std::ranges::find(elements_, "tristrips", &Element::name) != elements_.end();
      fail(fmt::format("has no {}; allowed: \"element {} COUNT\"{}", name, name,
                       has_strips ? " (triangle strips are not read: export the mesh with faces)" : ""));
    }
    const auto is_needed = [name](const Element& element) { return element.is_vertex() || element.name == name; };
    const auto end = std::find_if(elements_.rbegin(), elements_.rend(), is_needed).base();
    has_more_elements_ = end != elements_.end();
    elements_.erase(end, elements_.end());
    // Check the properties.
    check_vertices();
    const auto needed = std::ranges::find(elements_, name, &Element::name);
    if (wanted == Wanted::faces && needed->count(kCorners) != 1)
      fail_in_line(file_, needed->line, "allowed for a face: one \"property list COUNT INDEX vertex_indices\"");
  }

  /// Returns the elements up to the vertices (for points), or up to both vertices and faces (for a surface). Later
  /// elements are not read.
  const std::vector<Element>& elements() const { return elements_; }
  /// Returns true if the file has elements after elements().
  bool has_more_elements() const { return has_more_elements_; }
  bool is_text() const { return format_ == "ascii"; }
  /// Returns the byte order of a binary file. Precondition: !is_text().
  std::endian byte_order() const { return format_ == "binary_big_endian" ? std::endian::big : std::endian::little; }

 private:
  /// Parses the next line. Returns false at the end of the header.
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
      if (std::ranges::find(elements_, words[1], &Element::name) != elements_.end())
        fail(fmt::format("the element {} is declared twice; allowed: once", quoted_token(words[1])));
      elements_.push_back({words[1], lines_.line(), *entries});
    } else if (first == "property") {
      if (elements_.empty()) fail("got a property before an element; allowed: after one");
      elements_.back().properties.push_back(property(words));
    } else if (!first.empty() && first != "comment" && first != "obj_info") {
      fail(fmt::format("got {}; allowed: format, comment, obj_info, element, property, end_header",
                       quoted_token(first)));
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

  /// Parses "property TYPE NAME" (a number) or "property list COUNT TYPE NAME" (a list of numbers). The property
  /// belongs to the element that was declared last. This element and NAME determine the property's role.
  Property property(const Words& words) const {
    const bool is_list = words.size() == 5 && words[1] == "list";
    const PlyType* count = is_list ? ply_type(words[2]) : nullptr;
    const PlyType* type = is_list || words.size() == 3 ? ply_type(words[words.size() - 2]) : nullptr;
    if (type == nullptr || (is_list && (count == nullptr || count->is_real)))
      fail("allowed: \"property TYPE NAME\" or, with an integer COUNT, \"property list COUNT TYPE NAME\"");
    const std::string_view name = words.back();
    if (!is_list) {
      const auto role =
          static_cast<std::size_t>(std::ranges::find(kVertexProperties, name) - kVertexProperties.begin());
      return {nullptr, type, elements_.back().is_vertex() && role < numbers_ ? role : kIgnored};
    }
    const bool has_corners = elements_.back().name == "face" && (name == "vertex_indices" || name == "vertex_index");
    if (has_corners && type->is_real) fail("allowed for the vertices of a face: an integer type");
    return {count, type, has_corners ? kCorners : kIgnored};
  }

  /// Throws InputError if there are no vertices, or if a needed vertex property is not declared exactly once.
  void check_vertices() const {
    for (const Element& element : elements_) {
      if (!element.is_vertex()) continue;
      for (std::size_t i = 0; i < numbers_; ++i) {
        if (element.count(i) == 1) continue;
        fail(fmt::format("got {} vertex properties \"{}\"; allowed: one each of {}", element.count(i),
                         kVertexProperties[i],
                         fmt::join(kVertexProperties.begin(), kVertexProperties.begin() + numbers_, ", ")));
      }
    }
    if (std::ranges::none_of(elements_, &Element::is_vertex)) fail("has no vertex; allowed: \"element vertex COUNT\"");
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(file_, lines_.line(), problem); }

  LineReader& lines_;
  std::size_t numbers_;  ///< number of vertex properties to read: 3 (position) or 6 (position and normal)
  const fs::path& file_;
  std::optional<std::string_view> format_;
  std::vector<Element> elements_;
  bool has_more_elements_ = false;
};

/// Reads the values after the header in order. In a text file, each entry is a line and each value is a token. In a
/// binary file, values follow each other without separators.
class PlyValues {
 public:
  PlyValues(const LineReader& lines, const PlyHeader& header, const fs::path& file)
      : is_text_(header.is_text()),
        text_(lines, file),
        bytes_(lines.rest(), header.byte_order()),
        has_more_elements_(header.has_more_elements()),
        file_(file) {}

  /// Advances to the next entry, which is entry number `i` of `element`.
  void begin(const Element& element, std::size_t i) {
    element_ = &element;
    entry_ = i;
    word_ = 0;
    if (is_text_ && !text_.next()) fail_cut_short();
  }
  /// Ends the current entry. If the line of the entry has more values than the header declares, counts this line for
  /// warn_of_rest(). Call end() after all declared values of the entry were read.
  void end() {
    if (!is_text_ || word_ >= text_.words().size()) return;
    if (long_entries_++ == 0) first_long_line_ = text_.line();
  }
  /// Returns the line of the current entry; 0 in a binary file.
  std::size_t line() const { return is_text_ ? text_.line() : 0; }
  bool may_be_cut() const { return is_text_ && text_.may_be_cut(); }
  /// Adds warnings about values that were not read.
  void warn_of_rest(std::vector<std::string>& warnings) {
    if (long_entries_ > 0) {
      warnings.push_back(
          fmt::format("lines with more values than the header declares, which were ignored: {}, the first "
                      "is line {}",
                      long_entries_, first_long_line_));
    }
    if (has_more_elements_) return;
    if (is_text_) {
      text_.warn_of_rest(warnings);
    } else if (bytes_.left() > 0) {
      warnings.push_back(
          fmt::format("bytes after the last entry that the header declares, which were ignored: {}", bytes_.left()));
    }
  }
  /// Reads a number.
  double number(const PlyType& type) {
    if (!is_text_) return take(type);
    skip(1, type);
    const double value = text_.number(word_ - 1);
    if (!type.is_real && (value != std::round(value) || value < type.min || value > type.max))
      text_.fail(fmt::format("got {}, but the header declares this property as {}; allowed: an integer from {} to {}",
                             quoted_token(text_.words()[word_ - 1]), type.name, type.min, type.max));
    return value;
  }
  /// Reads a count or an index. `what` says in an error message what the number counts or means, such as "entries".
  std::int64_t whole(const PlyType& type, const char* what) {
    return is_text_ ? static_cast<std::int64_t>(text_.count(word_++, what)) : static_cast<std::int64_t>(take(type));
  }
  /// Skips `numbers` values.
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
      text_.fail(
          fmt::format("got {} values; allowed: all of a {}", text_.words().size(), quoted_token(element_->name)));
    if (is_text_) text_.fail_at_end(entry_, element_->entries, quoted_token(element_->name));
    fail(fmt::format("the file is cut short: it ends after {} of its {} {}; allowed: a complete file", entry_,
                     element_->entries, quoted_token(element_->name)));
  }

  bool is_text_;
  MeshLines text_;
  std::size_t word_ = 0;  ///< index of the next token in the text's line
  ByteReader bytes_;
  const Element* element_ = nullptr;
  std::size_t entry_ = 0;  ///< number of the current entry
  bool has_more_elements_;
  std::size_t long_entries_ = 0, first_long_line_ = 0;
  const fs::path& file_;
};

/// Contents of a PLY file: a surface or points, depending on `wanted`.
struct Contents {
  Wanted wanted;
  MeshFaces faces = {};
  std::vector<SurfacePoint> points = {};  ///< used instead of `faces` if points are wanted
};

/// Reads entry number `i` of an element and adds it to the contents.
void read_entry(const Element& element, std::size_t i, PlyValues& values, Contents& contents) {
  values.begin(element, i);
  Values vertex{};
  for (const Property& p : element.properties) {
    // Read and check the length of a list.
    const std::int64_t length = p.count ? values.whole(*p.count, "entries") : 1;
    if (p.role == kCorners && length < 3)
      values.fail(fmt::format("face {}: got {} corners; allowed: at least 3", i, length));
    if (length < 0) {
      values.fail(fmt::format("{} {}: got a list of {} entries; allowed: an integer from 0", quoted_token(element.name),
                              i, length));
    }
    // Read the values by their role.
    if (p.role == kIgnored) {
      values.skip(static_cast<std::size_t>(length), *p.type);
    } else if (p.role == kCorners) {
      // The cast turns a negative index of a binary file into a large index, which MeshFile rejects.
      for (std::int64_t k = 0; k < length; ++k)
        contents.faces.corners.push_back(static_cast<std::uint32_t>(values.whole(*p.type, "as a vertex")));
      contents.faces.end_face(values.line());
    } else {
      vertex[p.role] = values.number(*p.type);
    }
  }
  values.end();
  // Store the vertex.
  if (!element.is_vertex()) return;
  const Vec3 position(vertex[0], vertex[1], vertex[2]);
  if (contents.wanted == Wanted::points)
    contents.points.push_back({position, {vertex[3], vertex[4], vertex[5]}});
  else
    contents.faces.add_vertex(position, values.line());
}

Contents contents_of(std::string_view text, Wanted wanted, const fs::path& file) {
  LineReader lines(text);
  const PlyHeader header(lines, wanted, file);
  PlyValues values(lines, header, file);
  Contents contents{wanted};
  for (const Element& element : header.elements())
    for (std::size_t i = 0; i < element.entries && !element.properties.empty(); ++i)
      read_entry(element, i, values, contents);
  if (values.may_be_cut()) contents.faces.unfinished_line = values.line();
  values.warn_of_rest(contents.faces.warnings);
  return contents;
}

}  // namespace

MeshFaces read_ply(std::string_view text, const fs::path& file) {
  return contents_of(text, Wanted::faces, file).faces;
}

std::vector<SurfacePoint> parse_ply_points(std::string_view text, const fs::path& file,
                                           std::vector<std::string>* notes) {
  Contents contents = contents_of(text, Wanted::points, file);
  if (notes != nullptr) *notes = std::move(contents.faces.warnings);
  return std::move(contents.points);
}

}  // namespace hapbench
