#include "scenarios/input/rounding.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string>

namespace hapbench {

double rounded_to_digits(double value, int digits) {
  // Format and parse the number. Rounding by arithmetic would not give the nearest double, because powers of ten
  // such as 0.1 are not exact in binary.
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace hapbench
