#pragma once

#include <filesystem>
#include <string>

#include "scenarios/codec/codec.hpp"

namespace hapbench {

/// Largest JSON file read [bytes].
inline constexpr std::uintmax_t kLargestJsonFile = 64 << 20;

/// Reads a whole file. Throws InputError (place: none) when it cannot be read or is larger than `largest`.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// Parses JSON from outside, which may be hostile: refuses what is no JSON (with line and column), nesting deeper than
/// 64, objects with more than 10 000 keys, duplicate keys and numbers beyond double. Throws InputError.
Json parse_json(const std::string& text);

}  // namespace hapbench
