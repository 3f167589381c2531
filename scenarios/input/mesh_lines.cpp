#include "scenarios/input/mesh_lines.hpp"

#include <fmt/format.h>

#include <limits>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_formats.hpp"

namespace hapbench {

void add_polygon(std::span<const std::uint32_t> corners, TriangleSoup& soup) {
  for (std::size_t i = 2; i < corners.size(); ++i) soup.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

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
  if (!value) fail(fmt::format("got {}; allowed: a finite number", quoted_word(text)));
  return *value;
}

Vec3 MeshLines::position(std::size_t first) const {
  if (words_.size() < first + 3) fail(fmt::format("got {} coordinates; allowed: 3", words_.size() - first));
  const double x = number(first), y = number(first + 1), z = number(first + 2);
  return {x, y, z};
}

std::size_t MeshLines::count(std::size_t word, const char* what) const {
  const auto number = word < words_.size() ? whole_number(words_[word]) : std::nullopt;
  const std::size_t most = std::numeric_limits<std::int32_t>::max();
  if (!number || *number > most) {
    fail(fmt::format("got {} {}; allowed: an integer from 0", word < words_.size() ? quoted_word(words_[word]) : "no",
                     what));
  }
  return *number;
}

void MeshLines::add_face(std::size_t index, std::size_t first, TriangleSoup& soup) const {
  const std::size_t corners = count(first, "corners");
  if (corners < 3 || words_.size() <= first + corners)
    fail(fmt::format("face {}: got {} corners; allowed: at least 3, and as many vertices", index, corners));
  std::vector<std::uint32_t> vertices;
  vertices.reserve(corners);
  for (std::size_t k = 1; k <= corners; ++k)
    vertices.push_back(static_cast<std::uint32_t>(count(first + k, "as a vertex")));
  add_polygon(vertices, soup);
}

void MeshLines::fail(const std::string& problem) const {
  fail_in_line(file_, lines_.line(), problem);
}

}  // namespace hapbench
