#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hapbench {

/// Returns the contents of a file. Throws InputError without a location if the file cannot be read or is larger
/// than `largest` bytes, if it is a text in UTF-16 or UTF-32, or if it is compressed (gzip, zip).
///
/// The contents are the bytes of the file, because some formats are binary. LineReader skips the byte order mark of
/// UTF-8 and accepts all line ends.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// Returns the contents of a file that a scenario names. Throws InputError that names the file if it cannot be
/// read, is larger than 4 GiB or has another encoding.
std::string read_named_file(const std::filesystem::path& file);

}  // namespace hapbench
