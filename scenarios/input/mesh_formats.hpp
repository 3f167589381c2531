#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/triangle_soup.hpp"

/// Readers of the mesh formats, for mesh_file.hpp. Each takes the contents of a file, whose name is for messages, and
/// returns vertices and faces in the file's unit. Numbers of a text are read in double precision, those of binary files
/// as they are stored. Vertex indices are not compared with the number of vertices, and coordinates of binary files may
/// be infinite or NaN: MeshFile checks both for all formats. Files come from outside: each word is checked, and memory
/// grows with what a file holds, never with what it declares. Throws InputError that names the file, and the line of a
/// text.
namespace hapbench {

/// Wavefront OBJ: the lines "v" and "f"; other lines are ignored.
TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file);

/// OFF as a text, with or without normals, colours and texture coordinates.
TriangleSoup read_off(std::string_view text, const std::filesystem::path& file);

/// STL, text or binary.
TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file);

/// PLY, text or binary of either byte order. Elements and properties that are not part of the surface are ignored.
TriangleSoup read_ply(std::string_view text, const std::filesystem::path& file);

/// The vertices of a PLY file, which have the properties x, y, z [m], nx, ny, nz, of any type; everything after them,
/// such as faces, is not read.
std::vector<SurfacePoint> ply_points_in(std::string_view text, const std::filesystem::path& file);

/// Cuts a polygon into a fan of triangles from its first corner.
void add_polygon(std::span<const std::uint32_t> corners, TriangleSoup& soup);

/// The lines of a mesh file in text form, each as its words. Comments (from '#' to the end of the line) and blank lines
/// are skipped. Every function throws an InputError that names file and line when a word is not what it should be.
class MeshLines {
 public:
  MeshLines(LineReader lines, const std::filesystem::path& file) : lines_(lines), file_(file) {}

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
  const std::filesystem::path& file_;
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

}  // namespace hapbench
