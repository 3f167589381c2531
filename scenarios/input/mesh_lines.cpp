#include "scenarios/input/mesh_lines.hpp"

#include <fmt/format.h>

#include <limits>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {

/// Returns the line without its comment, which begins with '#'. The '#' of a number that is not finite, such as
/// "1.#QNAN" or "-1.#IND", begins no comment.
static std::string_view without_comment(std::string_view line) {
  const auto is_in_number = [line](std::size_t at) {
    return at > 0 && line[at - 1] == '.' && line.substr(at + 1).find_first_of("IQS") == 0;
  };
  std::size_t at = line.find('#');
  while (at != std::string_view::npos && is_in_number(at)) at = line.find('#', at + 1);
  return line.substr(0, at);
}

bool MeshLines::next() {
  while (const auto line = lines_.next()) {
    split_at_blanks(without_comment(*line), words_);
    first_line_ = lines_.line();
    joined_token_ = {};
    if (continuation_ == Continuation::backslash && !words_.empty() && words_.back().ends_with('\\')) continue_line();
    if (!words_.empty()) return true;
  }
  words_.clear();
  return false;
}

void MeshLines::continue_line() {
  while (!words_.empty() && words_.back().ends_with('\\')) {
    words_.back().remove_suffix(1);
    if (words_.back().empty()) words_.pop_back();
    const auto line = lines_.next();
    if (!line) fail("the file ends after a line that is continued with a backslash; allowed: a complete file");
    const Words more = words_of(without_comment(*line));
    words_.insert(words_.end(), more.begin(), more.end());
    if (more.empty()) return;
    joined_token_ = more.front();
  }
}

double MeshLines::number(std::size_t word) const {
  std::string_view text = words_[word];
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto value = finite_number(text);
  if (!value && has_decimal_comma(text))
    fail("got " + quoted_token(text) + " with a decimal comma; allowed: a number with a decimal point");
  if (!value) fail("got " + quoted_token(text) + "; allowed: a finite number" + cause_of_exponent(text));
  return *value;
}

Vec3 MeshLines::position(std::size_t first) const {
  if (words_.size() < first + 3) fail(fmt::format("got {} coordinates; allowed: 3", words_.size() - first));
  return {number(first), number(first + 1), number(first + 2)};
}

std::size_t MeshLines::count(std::size_t word, const char* what) const {
  const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
  if (number && *number <= std::numeric_limits<std::int32_t>::max()) return *number;
  const char* nothing = std::string_view(what).starts_with("as ") ? "nothing" : "no";
  fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted_token(words_[word]) : nothing,
                   what));
}

void MeshLines::fail(const std::string& problem) const {
  const char* cut = may_be_cut() ? " (the file ends within this line: is it cut short?)" : "";
  fail_in_line(file_, first_line_, problem + cut);
}

void MeshLines::fail_at_end(std::size_t done, std::size_t count, const std::string& what) const {
  fail_in_line(
      file_, lines_.line(),
      fmt::format("the file is cut short: it ends after {} of its {} {}; allowed: a complete file", done, count, what));
}

void MeshLines::note_ignored(std::size_t word) {
  if (last_ignored_line_ == first_line_) return;
  last_ignored_line_ = first_line_;
  if (ignored_lines_++ > 0) return;
  first_ignored_line_ = first_line_;
  first_ignored_token_ = words_[word];
}

void MeshLines::warn_of_ignored(std::vector<std::string>& warnings) const {
  if (ignored_lines_ == 0) return;
  warnings.push_back(
      fmt::format("lines with other text after the coordinates of a vertex, which was ignored: {}, the "
                  "first is line {}: {}",
                  ignored_lines_, first_ignored_line_, quoted_token(first_ignored_token_)));
}

void MeshLines::warn_of_rest(std::vector<std::string>& warnings) {
  if (!next()) return;
  const std::size_t first = first_line_;
  std::size_t count = 1;
  while (next()) ++count;
  warnings.push_back(
      fmt::format("lines after the last entry that the header declares, which were ignored: {}, the "
                  "first is line {}",
                  count, first));
}

}  // namespace hapbench
