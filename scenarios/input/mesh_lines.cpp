#include "scenarios/input/mesh_lines.hpp"

#include <fmt/format.h>

#include <limits>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

bool MeshLines::next() {
  while (const auto line = lines_.next()) {
    words_ = words_of(line->substr(0, line->find('#')));
    if (!words_.empty()) return true;
  }
  words_.clear();
  return false;
}

double MeshLines::number(std::size_t word) const {
  std::string_view text = words_[word];
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto value = finite_number(text);
  if (!value) fail("got " + quoted_token(text) + "; allowed: a finite number");
  return *value;
}

Vec3 MeshLines::position(std::size_t first) const {
  if (words_.size() < first + 3) fail(fmt::format("got {} coordinates; allowed: 3", words_.size() - first));
  return {number(first), number(first + 1), number(first + 2)};
}

std::size_t MeshLines::count(std::size_t word, const char* what) const {
  const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
  if (number && *number <= std::numeric_limits<std::int32_t>::max()) return *number;
  fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted_token(words_[word]) : "no",
                   what));
}

void MeshLines::fail(const std::string& problem) const {
  fail_in_line(file_, lines_.line(), problem);
}

}  // namespace hapbench
