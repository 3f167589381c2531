#include "scenarios/input/text_lines.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

void split_at_blanks(std::string_view line, Words& words) {
  words.clear();
  for (auto start = std::ranges::find_if_not(line, is_blank); start != line.end();) {
    const auto end = std::find_if(start, line.end(), is_blank);
    words.emplace_back(start, end);
    start = std::find_if_not(end, line.end(), is_blank);
  }
}

Words words_of(std::string_view line) {
  Words words;
  split_at_blanks(line, words);
  return words;
}

Words parts_of(std::string_view text, char separator) {
  Words parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> finite_number(std::string_view word) {
  const auto value = parse_number<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::string quoted_token(std::string_view word) {
  return shown(word.substr(0, 60));
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string warning_of_cut_line(std::string_view text) {
  if (text.empty() || text.back() == '\n' || text.back() == '\r') return "";
  LineReader lines(text);
  while (lines.next()) {
  }
  if (lines.line() < 2) return "";
  return fmt::format("line {}, the last line, has no line end: is the file cut short?", lines.line());
}

LineReader::LineReader(std::string_view text) : rest_(text) {
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  const std::string_view first = rest_.substr(0, rest_.find('\n'));
  newline_ = first.data() + first.size();
  const std::size_t cr = first.find('\r');
  ends_with_cr_ = cr != std::string_view::npos && (cr + 1 < first.size() || first.size() == rest_.size());
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  ++line_;
  // Search the next LF only once for all lines before it. In a text with CR line ends and without LF, each search would
  // otherwise scan the whole rest.
  const char* begin = rest_.data();
  if (newline_ < begin) newline_ = begin + std::min(rest_.find('\n'), rest_.size());
  const std::string_view until_newline = rest_.substr(0, static_cast<std::size_t>(newline_ - begin));
  const std::size_t length = std::min(until_newline.find('\r'), until_newline.size());
  // Skip the line end, which has one byte or two.
  std::size_t skipped = length;
  if (skipped < rest_.size() && rest_[skipped] == '\r') ++skipped;
  const bool ends_here = skipped == length || !ends_with_cr_;
  if (skipped < rest_.size() && rest_[skipped] == '\n' && ends_here) ++skipped;
  has_line_end_ = skipped > length;
  rest_.remove_prefix(skipped);
  return until_newline.substr(0, length);
}

}  // namespace hapbench
