#include <fmt/format.h>

#include <charconv>

#include "scenarios/input/mesh_formats.hpp"
#include "scenarios/input/mesh_lines.hpp"

namespace hapbench {
namespace {

/// The vertex that a corner of a face names: "7/1/3" is the seventh of the file, which may come later; "-1" the last
/// one of the `vertices` so far.
std::uint32_t vertex_of(std::string_view word, std::size_t vertices, const MeshLines& lines) {
  const std::string_view number = word.substr(0, word.find('/'));
  int index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  const bool parsed = error == std::errc() && end == number.data() + number.size();
  const auto count = static_cast<std::int64_t>(vertices);
  if (!parsed || index == 0 || index < -count) {
    lines.fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one",
                           quoted_word(word)));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

}  // namespace

TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file) {
  TriangleSoup soup;
  std::vector<std::uint32_t> corners;
  MeshLines lines{LineReader(text), file};
  while (lines.next()) {
    const Words& words = lines.words();
    if (words[0] == "v") {
      soup.vertices.push_back(lines.position(1));
    } else if (words[0] == "f") {
      if (words.size() < 4)
        lines.fail(fmt::format("got a face with {} corners; allowed: at least 3", words.size() - 1));
      corners.clear();
      for (std::size_t i = 1; i < words.size(); ++i)
        corners.push_back(vertex_of(words[i], soup.vertices.size(), lines));
      add_polygon(corners, soup);
    }
  }
  return soup;
}

}  // namespace hapbench
