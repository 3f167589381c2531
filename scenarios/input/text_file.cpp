#include "scenarios/input/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/pipe_contents.hpp"

namespace hapbench {

static constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30;  ///< maximum size of a named file: 4 GiB

/// Throws InputError if the contents begin as a text in UTF-16 or UTF-32 does, or as a compressed file does.
static void refuse_other_encodings(const std::string& text) {
  const auto begins = [&text](std::string_view bytes) { return text.starts_with(bytes); };
  const auto is_ascii = [&text](std::size_t i) { return i < text.size() && text[i] > 0; };
  const auto is_zero = [&text](std::size_t i) { return i < text.size() && text[i] == 0; };
  // Without a byte order mark, ASCII characters that alternate with zero bytes reveal the encoding.
  const auto is_ascii_pair = [&](std::size_t i) { return is_ascii(i) && is_ascii(i + 2); };
  const auto is_zero_pair = [&](std::size_t i) { return is_zero(i) && is_zero(i + 2); };
  const bool has_no_mark = (is_ascii_pair(0) && is_zero_pair(1)) || (is_zero_pair(0) && is_ascii_pair(1));
  const bool little = begins("\xFF\xFE") && ((is_ascii(2) && is_zero(3)) || (is_zero(2) && is_zero(3)));
  const bool big = begins("\xFE\xFF") && is_zero(2) && is_ascii(3);
  if (little || big || has_no_mark)
    throw InputError("is a text in UTF-16 or UTF-32; allowed: UTF-8 (save the file in this encoding)");
  for (const std::string_view start : {"\x1F\x8B", "PK\x03\x04", "BZh91AY&SY", "\xFD\x37zXZ", "\x28\xB5\x2F\xFD"})
    if (begins(start)) throw InputError("is compressed; allowed: the unpacked file (gzip -d, unzip, bzip2 -d, xz -d)");
}

std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest) {
  // The operating system would ignore the part of the name after the zero byte and open another file.
  if (file.native().find('\0') != std::string::npos) throw InputError("cannot be read: the name has a zero byte");
  // Return the stored contents of a pipe, because a pipe gives its bytes only once.
  if (const auto kept = pipe_contents().find(file)) return *kept;
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw InputError("is a directory, not a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("cannot be read: {}", std::strerror(errno)));
  // Read in chunks and check the size after each chunk, because the size of a pipe or device is not known in advance.
  std::string text;
  std::vector<char> chunk(1 << 16);
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || stream.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > largest) throw InputError(fmt::format("is larger than {} MiB", largest >> 20));
  }
  refuse_other_encodings(text);
  pipe_contents().keep(file, text);
  return text;
}

std::string read_named_file(const std::filesystem::path& file) {
  try {
    return read_text_file(file, kMaxFileBytes);
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

}  // namespace hapbench
