#include "scenarios/input/ply_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/ply_header.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

constexpr std::array<std::string_view, 6> kWanted = {"x", "y", "z", "nx", "ny", "nz"};
using Values = std::array<double, kWanted.size()>;

struct VertexProperty : PlyType {
  std::optional<int> wanted;  ///< which of kWanted it is
};

/// The vertices of a file, taken line by line or, in a binary file, value by value.
class Reader {
 public:
  Reader(std::string_view text, const std::filesystem::path& file) : file_(file), lines_(text) {}

  std::vector<SurfacePoint> points() {
    read_header();
    const std::size_t bytes = ascii() ? fewest_bytes(2) : fewest_bytes(0);
    if (lines_.rest().size() < bytes) {
      fail_in_line(file_, lines_.line(),
                   fmt::format("the file ends before its {} vertices; allowed: a complete file", vertices_));
    }
    rest_ = ByteReader(lines_.rest(), byte_order(format_));
    std::vector<SurfacePoint> points;
    points.reserve(vertices_);
    for (std::size_t i = 0; i < vertices_; ++i) {
      const Values v = ascii() ? read_text_vertex(i) : read_binary_vertex(i);
      points.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
    }
    return points;
  }

 private:
  bool ascii() const { return format_ == PlyFormat::ascii; }

  void read_header() {
    const PlyHeader header = read_ply_header(lines_, file_);
    format_ = header.format;
    if (header.elements.empty()) fail_in_line(file_, header.last_line, "allowed: a header with \"element vertex\"");
    vertices_ = read_vertex_count(header.elements[0]);
    for (const auto& declaration : header.elements[0].properties) properties_.push_back(read_property(declaration));
    for (std::size_t w = 0; w < kWanted.size(); ++w) {
      const auto count = std::count_if(properties_.begin(), properties_.end(),
                                       [w](const VertexProperty& p) { return p.wanted == static_cast<int>(w); });
      if (count == 1) continue;
      fail_in_line(
          file_, header.last_line,
          fmt::format("got {} vertex properties \"{}\"; allowed: one each of x, y, z, nx, ny, nz", count, kWanted[w]));
    }
  }

  std::size_t read_vertex_count(const PlyHeader::Element& element) const {
    const Words& words = element.words;
    if (words.size() != 3 || words[1] != "vertex")
      fail_in_line(file_, element.line, "allowed: \"element vertex COUNT\" as the first element");
    const auto count = whole_number(words[2]);
    if (!count || static_cast<double>(*count) > kMostPoints) {
      fail_in_line(
          file_, element.line,
          fmt::format("got {} vertices; allowed: an integer, at most {:.0g}", quoted_word(words[2]), kMostPoints));
    }
    return *count;
  }

  VertexProperty read_property(const PlyHeader::Declaration& declaration) const {
    const Words& words = declaration.words;
    const auto type = words.size() == 3 ? ply_type(words[1]) : std::nullopt;
    if (!type) {
      fail_in_line(file_, declaration.line,
                   "allowed for a vertex: \"property TYPE NAME\" with a type char, uchar, short, ushort, int, uint, "
                   "float or double");
    }
    const auto wanted = std::find(kWanted.begin(), kWanted.end(), words[2]);
    if (wanted == kWanted.end()) return {*type, std::nullopt};
    return {*type, static_cast<int>(wanted - kWanted.begin())};
  }

  /// Fewest bytes the vertices take: so a count that the file cannot hold is refused before memory is asked for it.
  std::size_t fewest_bytes(std::size_t bytes_per_number) const {
    std::size_t bytes = 0;
    for (const VertexProperty& p : properties_) bytes += bytes_per_number == 0 ? p.size : bytes_per_number;
    const std::size_t last_line_end = bytes_per_number == 0 || vertices_ == 0 ? 0 : 1;
    return vertices_ * bytes - last_line_end;
  }

  Values read_text_vertex(std::size_t index) {
    const Words words = words_of(lines_.next().value_or(""));
    if (words.size() != properties_.size()) {
      fail_in_line(file_, lines_.line(),
                   fmt::format("vertex {}: got {} numbers; allowed: {}", index, words.size(), properties_.size()));
    }
    Values values{};
    for (std::size_t p = 0; p < words.size(); ++p) {
      const auto value = finite_number(words[p]);
      if (!value) {
        fail_in_line(file_, lines_.line(),
                     fmt::format("vertex {}: got {}; allowed: a finite number", index, quoted_word(words[p])));
      }
      if (properties_[p].wanted) values[static_cast<std::size_t>(*properties_[p].wanted)] = *value;
    }
    return values;
  }

  Values read_binary_vertex(std::size_t index) {
    Values values{};
    for (const VertexProperty& property : properties_) {
      const double value = take_ply_number(rest_, property);
      if (property.wanted) values[static_cast<std::size_t>(*property.wanted)] = value;
    }
    for (const double value : values) {
      if (std::isfinite(value)) continue;
      fail_in_file(file_, fmt::format("vertex {}: got {}; allowed: finite numbers", index, value));
    }
    return values;
  }

  const std::filesystem::path& file_;
  LineReader lines_;
  ByteReader rest_{"", std::endian::little};  ///< of a binary file: what has not been read yet
  PlyFormat format_ = PlyFormat::ascii;
  std::size_t vertices_ = 0;
  std::vector<VertexProperty> properties_;  ///< of a vertex, in their order
};

}  // namespace

std::vector<SurfacePoint> ply_points_in(std::string_view text, const std::filesystem::path& file) {
  return Reader(text, file).points();
}

}  // namespace hapbench
