#pragma once

#include <filesystem>
#include <string>

#include "scenarios/input/text_lines.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

/// The lines of a mesh file in text form, each as its words. Comments (from '#' to the end of the line) and blank lines
/// are passed over. Every function throws an InputError that names file and line when a word is not what it should be.
class MeshLines {
 public:
  MeshLines(LineReader lines, const std::filesystem::path& file) : lines_(lines), file_(file) {}

  /// Goes to the next line that has words; false at the end of the text.
  bool next();
  const Words& words() const { return words_; }
  /// What stands behind the line at hand.
  std::string_view rest() const { return lines_.rest(); }

  /// The word as a finite number. Precondition: there is such a word.
  double number(std::size_t word) const;
  /// Three coordinates from that word on.
  Vec3 position(std::size_t first) const;
  /// The word as a count or an index, within 31 bits; `what` it counts is for the message.
  std::size_t count(std::size_t word, const char* what) const;
  /// Adds face `index` of the file, which the words from `first` on describe: how many corners, then their vertices.
  void add_face(std::size_t index, std::size_t first, TriangleSoup& soup) const;

  [[noreturn]] void fail(const std::string& problem) const;

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  Words words_;  ///< of the line at hand
};

}  // namespace hapbench
