#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Text files taken apart: lines, words, numbers.
namespace hapbench {

using Words = std::vector<std::string_view>;

/// The words of a line, separated by white space.
Words words_of(std::string_view line);

/// The parts of a text between separators, empty ones included; one more than there are separators.
Words parts_of(std::string_view text, char separator);

/// The whole word as a finite number, or none.
std::optional<double> finite_number(std::string_view word);

/// The whole word as a count or index, or none.
std::optional<std::size_t> whole_number(std::string_view word);

/// The word as an error message shows it: in quotes, control characters escaped, cut when long.
std::string quoted_word(std::string_view word);

/// ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// Gives the lines of a text, which must outlive it, one by one.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its end; none at the end of the text.
  std::optional<std::string_view> next();
  /// Number, from 1, of the last line given.
  std::size_t line() const { return line_; }
  /// What has not been given yet.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

}  // namespace hapbench
