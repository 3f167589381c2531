#include "scenarios/input/ply_header.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

std::optional<PlyFormat> format_of(const Words& words) {
  if (words.size() != 3 || words[2] != "1.0") return std::nullopt;
  if (words[1] == "ascii") return PlyFormat::ascii;
  if (words[1] == "binary_little_endian") return PlyFormat::little_endian;
  if (words[1] == "binary_big_endian") return PlyFormat::big_endian;
  return std::nullopt;
}

}  // namespace

std::optional<PlyType> ply_type(std::string_view name) {
  using enum PlyType::Kind;
  constexpr struct {
    std::string_view name, alias;
    PlyType type;
  } kTypes[] = {{"char", "int8", {signed_integer, 1}},   {"uchar", "uint8", {unsigned_integer, 1}},
                {"short", "int16", {signed_integer, 2}}, {"ushort", "uint16", {unsigned_integer, 2}},
                {"int", "int32", {signed_integer, 4}},   {"uint", "uint32", {unsigned_integer, 4}},
                {"float", "float32", {real, 4}},         {"double", "float64", {real, 8}}};
  for (const auto& t : kTypes) {
    if (name == t.name || name == t.alias) return t.type;
  }
  return std::nullopt;
}

double take_ply_number(ByteReader& reader, PlyType type) {
  switch (type.kind) {
    case PlyType::Kind::signed_integer:
      if (type.size == 1) return reader.take<std::int8_t>();
      return type.size == 2 ? reader.take<std::int16_t>() : reader.take<std::int32_t>();
    case PlyType::Kind::unsigned_integer:
      if (type.size == 1) return reader.take<std::uint8_t>();
      return type.size == 2 ? reader.take<std::uint16_t>() : reader.take<std::uint32_t>();
    case PlyType::Kind::real:
      return type.size == 4 ? reader.take<float>() : reader.take<double>();
  }
  return 0.0;
}

PlyHeader read_ply_header(LineReader& lines, const std::filesystem::path& file) {
  PlyHeader header;
  std::optional<PlyFormat> format;
  const auto fail = [&](const std::string& problem) { fail_in_line(file, lines.line(), problem); };
  for (;;) {
    const auto line = lines.next();
    if (!line) fail("the header does not end; allowed: a PLY header up to \"end_header\"");
    const Words words = words_of(*line);
    const std::string_view first = words.empty() ? "" : words[0];
    if (lines.line() == 1) {
      if (words != Words{"ply"}) fail("is not a PLY file; allowed: \"ply\" as the first line");
    } else if (first == "end_header") {
      break;
    } else if (first == "format") {
      format = format_of(words);
      if (!format) fail("unknown format; allowed: ascii, binary_little_endian or binary_big_endian, 1.0");
    } else if (first == "element") {
      header.elements.push_back({{lines.line(), words}, {}});
    } else if (first == "property") {
      if (header.elements.empty()) fail("got a property before an element; allowed: after one");
      header.elements.back().properties.push_back({lines.line(), words});
    } else if (first != "comment" && first != "obj_info") {
      fail(
          fmt::format("got {}; allowed: format, comment, obj_info, element, property, end_header", quoted_word(first)));
    }
  }
  if (!format) fail("allowed: a header with \"format\"");
  header.format = *format;
  header.last_line = lines.line();
  return header;
}

}  // namespace hapbench
