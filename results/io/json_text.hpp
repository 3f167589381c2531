#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace hapbench {

/// A number as text, without allocation: integers in decimal, doubles as the shortest decimal that reads back as the
/// same double ("0.1", "1e-05", "-0", "inf", "nan").
class NumberText {
 public:
  template <class Number>
  requires std::same_as<Number, double> || std::integral<Number>
  explicit NumberText(Number value) noexcept {
    size_ =
        static_cast<std::size_t>(std::to_chars(text_.data(), text_.data() + text_.size(), value).ptr - text_.data());
  }

  operator std::string_view() const noexcept { return {text_.data(), size_}; }  // NOLINT: it is a text

 private:
  std::array<char, 32> text_{};  // the longest shortest double has 24 characters, an integer of 64 bits 20
  std::size_t size_ = 0;
};

/// The text of a result file: keys in their order, two spaces of indentation, arrays of plain values on one line, a
/// final newline. Doubles are the shortest decimals that read back the same (nlohmann's own writer is not always
/// shortest); those that are not finite, for which JSON has no word, become null.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace hapbench
