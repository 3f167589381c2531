#pragma once

#include <bit>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "scenarios/input/byte_reader.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

enum class PlyFormat { ascii, little_endian, big_endian };

/// Precondition: the format is a binary one.
inline std::endian byte_order(PlyFormat format) {
  return format == PlyFormat::big_endian ? std::endian::big : std::endian::little;
}

/// Type of a number in a PLY file.
struct PlyType {
  enum class Kind { signed_integer, unsigned_integer, real };
  Kind kind;
  std::size_t size;  ///< in a binary file [bytes]
};
std::optional<PlyType> ply_type(std::string_view name);

/// The next number of a binary file; a double holds every one. Precondition: as many bytes are left.
double take_ply_number(ByteReader& reader, PlyType type);

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
