#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sim/core/types.hpp"

namespace hapbench {

/// Keeps the order of keys, so that written scenarios read like the documentation. Only declared here, because its
/// definition takes a compiler long: a source that makes one or takes one apart includes <nlohmann/json.hpp>.
using Json = nlohmann::ordered_json;

/// Largest JSON file read [bytes].
inline constexpr std::uintmax_t kLargestJsonFile = 64 << 20;

/// Reads a whole file. Throws InputError (place: none) when it cannot be read or is larger than `largest`.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// Parses JSON from outside, which may be hostile: refuses what is no JSON (with line, column and a hint at comments,
/// commas, quotes and encodings), nesting deeper than 64, objects with more than 10 000 keys, duplicate keys and
/// numbers beyond double. Throws InputError.
Json parse_json(const std::string& text);

/// The value as an error message shows it: JSON on one line, cut when long.
std::string shown(const Json& json);
std::string shown(double value);
std::string shown(const Vec3& value);
std::string shown(std::string_view text);

/// Pointer of a member or an element; `~` and `/` escaped as RFC 6901 says.
std::string member(const std::string& at, const std::string& name);
std::string element(const std::string& at, std::size_t index);

}  // namespace hapbench
