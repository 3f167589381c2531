#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"

namespace hapbench {

enum class PlyFormat { ascii, little_endian, big_endian };

/// Type of a number in a PLY file.
struct PlyType {
  enum class Kind { signed_integer, unsigned_integer, real };
  Kind kind;
  std::size_t size;  ///< in a binary file [bytes]
};
std::optional<PlyType> ply_type(std::string_view name);

/// The declarations of a PLY file, as words with the number of their line: what is allowed in them depends on the use.
struct PlyHeader {
  struct Declaration {
    std::size_t line = 0;
    Words words;
  };
  struct Element : Declaration {
    std::vector<Declaration> properties;
  };
  PlyFormat format = PlyFormat::ascii;
  std::size_t last_line = 0;
  std::vector<Element> elements;
};

/// Reads from "ply" to "end_header". Throws InputError that names file and line.
PlyHeader read_ply_header(LineReader& lines, const std::filesystem::path& file);

}  // namespace hapbench
