#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string_view>

namespace hapbench {

/// Reads the numbers of a binary file one after another. The bytes must outlive the reader.
class ByteReader {
 public:
  /// `order` is the byte order of the file.
  ByteReader(std::string_view bytes, std::endian order) : bytes_(bytes), order_(order) {}

  /// Returns the number of bytes that have not been read yet.
  std::size_t left() const { return bytes_.size(); }
  /// Skips the next `bytes` bytes. Precondition: at least `bytes` bytes are left.
  void skip(std::size_t bytes) { bytes_.remove_prefix(bytes); }

  /// Reads the next number. Precondition: at least sizeof(T) bytes are left.
  template <class T>
  T take() {
    std::array<char, sizeof(T)> number;
    std::copy_n(bytes_.begin(), sizeof(T), number.begin());
    bytes_.remove_prefix(sizeof(T));
    if (order_ != std::endian::native) std::reverse(number.begin(), number.end());
    return std::bit_cast<T>(number);
  }

 private:
  std::string_view bytes_;
  std::endian order_;
};

}  // namespace hapbench
