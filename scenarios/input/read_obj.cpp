#include "scenarios/input/read_obj.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "scenarios/input/mesh_lines.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns the vertex index, from 0, of a face's corner. The token "7/1/3" means the file's 7th vertex. The token
/// "-1" means the last of the `vertices` vertices that were read so far.
std::uint32_t vertex_of(std::string_view word, std::size_t vertices, const MeshLines& lines) {
  const auto index = parse_number<int>(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  if (!index || *index == 0 || *index < -count) {
    lines.fail(fmt::format("got {}; allowed: the number of a vertex, from 1, or back from -1, the last one",
                           quoted_token(word)));
  }
  return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
}

}  // namespace

TriangleSoup read_obj(std::string_view text, const fs::path& file) {
  TriangleSoup soup;
  MeshLines lines{LineReader(text), file};
  while (lines.next()) {
    const Words& words = lines.words();
    if (words[0] == "v") {
      soup.vertices.push_back(lines.position(1));
    } else if (words[0] == "f") {
      if (words.size() < 4)
        lines.fail(fmt::format("got a face with {} corners; allowed: at least 3", words.size() - 1));
      add_polygon(words.size() - 1, soup,
                  [&](std::size_t k) { return vertex_of(words[k + 1], soup.vertices.size(), lines); });
    }
  }
  return soup;
}

}  // namespace hapbench
