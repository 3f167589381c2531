#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hapbench {

/// Returns the contents of a file. Throws InputError without a location if the file cannot be read or is larger
/// than `largest` bytes.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// Returns the contents of a file that a scenario names. Throws InputError that names the file if it cannot be
/// read or is larger than 4 GiB.
std::string read_named_file(const std::filesystem::path& file);

}  // namespace hapbench
