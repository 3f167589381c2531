#include "scenarios/input/rounding.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string>

namespace hapbench {

double rounded_to_digits(double value, int digits) {
  // By way of the text, because multiples of a power of ten are not exact in binary.
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace hapbench
