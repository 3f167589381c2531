#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hapbench {

/// JSON that keeps the order of keys, so that written scenarios read like the documentation. This header only declares
/// it to save compile time: a source that creates or reads values includes <nlohmann/json.hpp>.
using Json = nlohmann::ordered_json;

/// Largest JSON file read [bytes].
inline constexpr std::uintmax_t kLargestJsonFile = 64 << 20;

/// Parses JSON that may be hostile. Throws InputError for syntax errors (with line, column and what was expected),
/// nesting deeper than 64, objects with more than 10 000 keys, duplicate keys and numbers beyond the range of double.
Json parse_json(const std::string& text);

/// Parses a file of at most kLargestJsonFile bytes. Throws InputError of both, without the file's name.
Json read_json(const std::filesystem::path& file);

/// The value as an error message shows it: JSON on one line, cut when long.
std::string shown(const Json& json);

/// JSON pointer of a member or an element of the value at `at`, escaped as in RFC 6901.
std::string member(const std::string& at, const std::string& name);
std::string element(const std::string& at, std::size_t index);

}  // namespace hapbench
