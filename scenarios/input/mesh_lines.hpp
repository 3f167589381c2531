#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "sim/core/types.hpp"

/// Functions that the readers of mesh files share. Files are untrusted: every token is checked, and memory grows
/// with the actual content of a file, never with a count that the file declares.
namespace hapbench {

/// Selects whether a backslash at the end of a line continues the line, as in OBJ.
enum class Continuation { none, backslash };

/// Reads a mesh file in text form line by line and splits each line into tokens at white space. Skips comments
/// (from '#' to the end of the line) and blank lines. Every function throws an InputError with file and line if a
/// token is invalid. If the line is the last line and has no line end, the message adds that the file may be cut short.
class MeshLines {
 public:
  /// The text and the path must outlive the object.
  MeshLines(LineReader lines, const std::filesystem::path& file, Continuation continuation = Continuation::none)
      : lines_(lines), file_(file), continuation_(continuation) {}

  /// Advances to the next line with tokens. Returns false at the end of the text.
  bool next();
  const Words& words() const { return words_; }
  /// Returns the number of the current line, from 1. A continued line has the number of its first line.
  std::size_t line() const { return first_line_; }
  /// Returns the first token of the last line that a backslash joined to the current line; empty if no line was joined.
  std::string_view joined_token() const { return joined_token_; }
  /// Returns true if the current line is the last line and has no line end, as if the file was cut within it.
  bool may_be_cut() const { return !lines_.has_line_end(); }

  /// Returns the token with the index `word` as a finite number. Precondition: word < words().size().
  double number(std::size_t word) const;
  /// Returns the three coordinates in the tokens from index `first` on, in the file's unit.
  Vec3 position(std::size_t first) const;
  /// Returns the token with the index `word` as a count or an index below 2^31. `what` names the counted items in
  /// the error message.
  std::size_t count(std::size_t word, const char* what) const;
  /// Throws an InputError that names file and line.
  [[noreturn]] void fail(const std::string& problem) const;
  /// Throws an InputError: the file ends after `done` of `count` entries. `what` names the entries.
  [[noreturn]] void fail_at_end(std::size_t done, std::size_t count, const std::string& what) const;
  /// Counts the current line for warn_of_ignored(). `word`: index of a token after the coordinates of a vertex.
  void note_ignored(std::size_t word);
  /// Adds a warning about the lines that note_ignored() counted, if there are any.
  void warn_of_ignored(std::vector<std::string>& warnings) const;
  /// Adds a warning about lines that remain after the last entry, if there are any.
  void warn_of_rest(std::vector<std::string>& warnings);

 private:
  /// Appends the tokens of continuation lines while a line ends with a backslash.
  void continue_line();

  LineReader lines_;
  const std::filesystem::path& file_;
  Continuation continuation_;
  std::size_t first_line_ = 0;
  std::string_view joined_token_;
  Words words_;  ///< tokens of the current line
  std::size_t ignored_lines_ = 0, first_ignored_line_ = 0, last_ignored_line_ = 0;
  std::string_view first_ignored_token_;
};

}  // namespace hapbench
