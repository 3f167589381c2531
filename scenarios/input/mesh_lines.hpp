#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "scenarios/input/text_lines.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// Functions that the readers of mesh files share. Files are untrusted: every token is checked, and memory grows
/// with the actual content of a file, never with a count that the file declares.
namespace hapbench {

/// Splits a polygon into a fan of triangles around its first corner and appends them to the soup. `corner(k)`
/// returns the vertex index of corner k. It is called once for each k, in ascending order. Precondition: corners
/// >= 2.
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

/// Reads a mesh file in text form line by line and splits each line into tokens at white space. Skips comments
/// (from '#' to the end of the line) and blank lines. Every function throws an InputError with file and line if a
/// token is invalid.
class MeshLines {
 public:
  /// The text and the path must outlive the object.
  MeshLines(LineReader lines, const std::filesystem::path& file) : lines_(lines), file_(file) {}

  /// Advances to the next line with tokens. Returns false at the end of the text.
  bool next();
  const Words& words() const { return words_; }

  /// Returns the token with the index `word` as a finite number. Precondition: word < words().size().
  double number(std::size_t word) const;
  /// Returns the three coordinates in the tokens from index `first` on, in the file's unit.
  Vec3 position(std::size_t first) const;
  /// Returns the token with the index `word` as a count or an index below 2^31. `what` names the counted items in
  /// the error message.
  std::size_t count(std::size_t word, const char* what) const;
  /// Throws an InputError that names file and line.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  Words words_;  ///< tokens of the current line
};

}  // namespace hapbench
