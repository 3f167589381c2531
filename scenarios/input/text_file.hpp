#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hapbench {

/// Returns the contents of a file. Throws InputError without a location if the file cannot be read, is larger than
/// `largest` bytes, is a text in UTF-16 or UTF-32, or is compressed (gzip, zip, bzip2, xz or zstd).
///
/// The contents are the bytes of the file, because some formats are binary. LineReader skips the byte order mark of
/// UTF-8 and accepts all line ends.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest);

/// Returns the contents of a file that a scenario names. Throws InputError that names the file if it is larger than 4
/// GiB or read_text_file() rejects it.
std::string read_named_file(const std::filesystem::path& file);

}  // namespace hapbench
