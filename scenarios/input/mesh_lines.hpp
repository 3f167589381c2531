#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "scenarios/input/text_lines.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// The parts that the readers of mesh files share. Files come from outside: each word is checked, and memory grows with
/// what a file holds, never with what it declares.
namespace hapbench {

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
  /// The text and the path must outlive the object.
  MeshLines(LineReader lines, const std::filesystem::path& file) : lines_(lines), file_(file) {}

  /// Goes to the next line that has words; false at the end of the text.
  bool next();
  const Words& words() const { return words_; }

  /// The word as a finite number. Precondition: there is such a word.
  double number(std::size_t word) const;
  /// Three coordinates from that word on.
  Vec3 position(std::size_t first) const;
  /// The word as a count or an index, within 31 bits; `what` it counts is for the message.
  std::size_t count(std::size_t word, const char* what) const;
  /// Throws an InputError that names file and line.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  Words words_;  ///< of the current line
};

}  // namespace hapbench
