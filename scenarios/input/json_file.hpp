#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hapbench {

/// JSON value that keeps the order of keys, so that written scenarios have the order of the documentation. To
/// save compile time, this header only declares the type. A source that creates or reads values includes
/// <nlohmann/json.hpp>.
using Json = nlohmann::ordered_json;

/// Maximum size of a JSON file [bytes]. Larger files are rejected.
inline constexpr std::uintmax_t kMaxJsonFileBytes = 64 << 20;

/// Parses JSON from an untrusted source. Throws InputError for syntax errors (with line, column and the expected
/// token), for nesting deeper than 64 levels, for objects with more than 10 000 keys, for duplicate keys and for
/// numbers beyond the range of double.
Json parse_json(const std::string& text);

/// Reads and parses a file. Throws InputError, without the file's name, if the file cannot be read, is larger than
/// kMaxJsonFileBytes, or has JSON that parse_json() rejects.
Json read_json(const std::filesystem::path& file);

/// Returns the value in the form for error messages: JSON on one line, truncated if it is long. A list or object with
/// more than 20 entries is replaced by its number of entries.
std::string shown(const Json& json);

/// Returns the JSON pointer of a member of the object at the pointer `at`, escaped by RFC 6901.
std::string member(const std::string& at, const std::string& name);
/// Returns the JSON pointer of an element of the list at the pointer `at`.
std::string element(const std::string& at, std::size_t index);

}  // namespace hapbench
