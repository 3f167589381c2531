#include "scenarios/files/ply_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "scenarios/codec/codec.hpp"
#include "scenarios/codec/size_limits.hpp"
#include "scenarios/files/json_file.hpp"
#include "scenarios/files/number_table.hpp"

namespace hapbench {
namespace {

constexpr std::array<std::string_view, 6> kWanted = {"x", "y", "z", "nx", "ny", "nz"};
using Values = std::array<double, kWanted.size()>;
using Words = std::vector<std::string_view>;

enum class Format { ascii, little_endian, big_endian };
enum class Kind { signed_integer, unsigned_integer, real };

struct Property {
  Kind kind;
  std::size_t size;           ///< in a binary file [bytes]
  std::optional<int> wanted;  ///< which of kWanted it is
};

struct Header {
  Format format = Format::ascii;
  std::size_t vertices = 0;
  std::vector<Property> properties;  ///< of a vertex, in their order
};

std::optional<Property> property_of_type(std::string_view type) {
  constexpr struct {
    std::string_view name, alias;
    Kind kind;
    std::size_t size;
  } kTypes[] = {{"char", "int8", Kind::signed_integer, 1},   {"uchar", "uint8", Kind::unsigned_integer, 1},
                {"short", "int16", Kind::signed_integer, 2}, {"ushort", "uint16", Kind::unsigned_integer, 2},
                {"int", "int32", Kind::signed_integer, 4},   {"uint", "uint32", Kind::unsigned_integer, 4},
                {"float", "float32", Kind::real, 4},         {"double", "float64", Kind::real, 8}};
  for (const auto& t : kTypes) {
    if (type == t.name || type == t.alias) return Property{t.kind, t.size, {}};
  }
  return std::nullopt;
}

Words words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  Words words;
  for (std::size_t start = line.find_first_not_of(kBlank); start != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, start), line.size());
    words.push_back(line.substr(start, end - start));
    start = line.find_first_not_of(kBlank, end);
  }
  return words;
}

/// The bytes of a file, taken line by line and then, in a binary file, value by value.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    try {
      text_ = read_text_file(file, kLargestTable);
    } catch (const InputError& error) {
      throw InputError(InputError::Kind::relation, file.string(), error.problem());
    }
    rest_ = text_;
  }

  std::vector<SurfacePoint> points() {
    const Header header = read_header();
    std::vector<SurfacePoint> points;
    const std::size_t bytes = header.format == Format::ascii ? read_limit(header, 2) : read_limit(header, 0);
    if (rest_.size() < bytes) {
      fail_in_header(fmt::format("the file ends before its {} vertices; allowed: a complete file", header.vertices));
    }
    points.reserve(header.vertices);
    for (std::size_t i = 0; i < header.vertices; ++i) {
      const Values v = header.format == Format::ascii ? read_text_vertex(header, i) : read_binary_vertex(header, i);
      points.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
    }
    return points;
  }

 private:
  [[noreturn]] void fail(const std::string& where, const std::string& problem) const {
    throw InputError(InputError::Kind::relation, file_.string() + where, problem);
  }
  [[noreturn]] void fail_in_header(const std::string& problem) const { fail(fmt::format(", line {}", line_), problem); }

  /// The next line without its end; none at the end of the file.
  std::optional<std::string_view> next_line() {
    if (rest_.empty()) return std::nullopt;
    ++line_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return line;
  }

  Header read_header() {
    Header header;
    bool has_format = false, has_vertices = false, in_vertices = false;
    for (;;) {
      const auto line = next_line();
      if (!line) fail_in_header("the header does not end; allowed: a PLY header up to \"end_header\"");
      const Words words = words_of(*line);
      const std::string_view first = words.empty() ? "" : words[0];
      if (line_ == 1) {
        if (words != Words{"ply"}) fail_in_header("is not a PLY file; allowed: \"ply\" as the first line");
      } else if (first == "end_header") {
        break;
      } else if (first == "format") {
        header.format = read_format(words);
        has_format = true;
      } else if (first == "element") {
        if (!has_vertices) header.vertices = read_vertex_count(words);
        in_vertices = !has_vertices;
        has_vertices = true;
      } else if (first == "property") {
        if (in_vertices) header.properties.push_back(read_property(words));
      } else if (first != "comment" && first != "obj_info") {
        fail_in_header(fmt::format("got {}; allowed: format, comment, obj_info, element, property, end_header",
                                   shown(Json(first.substr(0, 60)))));
      }
    }
    if (!has_format || !has_vertices) fail_in_header("allowed: a header with \"format\" and \"element vertex\"");
    for (std::size_t w = 0; w < kWanted.size(); ++w) {
      const auto count = std::count_if(header.properties.begin(), header.properties.end(),
                                       [w](const Property& p) { return p.wanted == static_cast<int>(w); });
      if (count != 1) {
        fail_in_header(fmt::format("got {} vertex properties \"{}\"; allowed: one each of x, y, z, nx, ny, nz", count,
                                   kWanted[w]));
      }
    }
    return header;
  }

  Format read_format(const Words& words) const {
    if (words.size() == 3 && words[2] == "1.0") {
      if (words[1] == "ascii") return Format::ascii;
      if (words[1] == "binary_little_endian") return Format::little_endian;
      if (words[1] == "binary_big_endian") return Format::big_endian;
    }
    fail_in_header("unknown format; allowed: ascii, binary_little_endian or binary_big_endian, 1.0");
  }

  std::size_t read_vertex_count(const Words& words) const {
    if (words.size() != 3 || words[1] != "vertex")
      fail_in_header("allowed: \"element vertex COUNT\" as the first element");
    std::size_t count = 0;
    const auto [end, error] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
    const bool number = error == std::errc() && end == words[2].data() + words[2].size();
    if (!number || static_cast<double>(count) > kMostPoints) {
      fail_in_header(fmt::format("got {} vertices; allowed: an integer, at most {:.0g}",
                                 shown(Json(words[2].substr(0, 60))), kMostPoints));
    }
    return count;
  }

  Property read_property(const Words& words) const {
    auto property = words.size() == 3 ? property_of_type(words[1]) : std::nullopt;
    if (!property) {
      fail_in_header(
          "allowed for a vertex: \"property TYPE NAME\" with a type char, uchar, short, ushort, int, uint, "
          "float or double");
    }
    const auto wanted = std::find(kWanted.begin(), kWanted.end(), words[2]);
    if (wanted != kWanted.end()) property->wanted = static_cast<int>(wanted - kWanted.begin());
    return *property;
  }

  /// Fewest bytes the vertices take: so a count that the file cannot hold is refused before memory is asked for it.
  static std::size_t read_limit(const Header& header, std::size_t bytes_per_number) {
    std::size_t bytes = 0;
    for (const Property& p : header.properties) bytes += bytes_per_number == 0 ? p.size : bytes_per_number;
    const std::size_t last_line_end = bytes_per_number == 0 || header.vertices == 0 ? 0 : 1;
    return header.vertices * bytes - last_line_end;
  }

  Values read_text_vertex(const Header& header, std::size_t index) {
    const Words words = words_of(next_line().value_or(""));
    const std::string where = fmt::format(", line {}", line_);
    if (words.size() != header.properties.size()) {
      fail(where, fmt::format("vertex {}: got {} numbers; allowed: {}", index, words.size(), header.properties.size()));
    }
    Values values{};
    for (std::size_t p = 0; p < words.size(); ++p) {
      double value = 0.0;
      const auto [end, error] = std::from_chars(words[p].data(), words[p].data() + words[p].size(), value);
      if (error != std::errc() || end != words[p].data() + words[p].size() || !std::isfinite(value)) {
        fail(where,
             fmt::format("vertex {}: got {}; allowed: a finite number", index, shown(Json(words[p].substr(0, 60)))));
      }
      if (header.properties[p].wanted) values[static_cast<std::size_t>(*header.properties[p].wanted)] = value;
    }
    return values;
  }

  Values read_binary_vertex(const Header& header, std::size_t index) {
    Values values{};
    for (const Property& property : header.properties) {
      const double value = read_binary(property, header.format);
      if (property.wanted) values[static_cast<std::size_t>(*property.wanted)] = value;
    }
    for (const double value : values) {
      if (!std::isfinite(value)) fail("", fmt::format("vertex {}: got {}; allowed: finite numbers", index, value));
    }
    return values;
  }

  /// Precondition: enough bytes are left.
  double read_binary(const Property& property, Format format) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < property.size; ++i) {
      const std::size_t from = format == Format::big_endian ? i : property.size - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(rest_[from]);
    }
    rest_.remove_prefix(property.size);
    switch (property.kind) {
      case Kind::signed_integer:
        return property.size == 1   ? static_cast<std::int8_t>(bits)
               : property.size == 2 ? static_cast<std::int16_t>(bits)
                                    : static_cast<std::int32_t>(bits);
      case Kind::unsigned_integer:
        return static_cast<double>(bits);
      case Kind::real:
        return property.size == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                                  : std::bit_cast<double>(bits);
    }
    return 0.0;
  }

  const std::filesystem::path& file_;
  std::string text_;
  std::string_view rest_;  ///< what has not been read yet
  std::size_t line_ = 0;   ///< of the last line read
};

}  // namespace

std::vector<SurfacePoint> read_ply_points(const std::filesystem::path& file) {
  return Reader(file).points();
}

}  // namespace hapbench
