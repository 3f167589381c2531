#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hapbench {

/// Reads a whole file. Throws InputError without a place when it cannot be read or is larger than `largest` bytes.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// The bytes of a file that a scenario names. Throws InputError that names the file.
std::string read_named_file(const std::filesystem::path& file);

}  // namespace hapbench
