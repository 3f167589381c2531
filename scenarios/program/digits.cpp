#include "scenarios/program/digits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "results/io/columns.hpp"
#include "scenarios/input/rounding.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

std::string significant(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "-";
}

std::string rounded_text(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const double rounded = rounded_to_digits(value, digits), size = std::abs(rounded);
  if (size >= 1e-4 && size < 1.0) return fmt::format("{}", rounded);
  return std::string(std::string_view(NumberText(rounded)));
}

int deserved_digits(double value, const std::optional<double>& tolerance, int max_digits) {
  if (!tolerance || !(*tolerance > 0.0) || value == 0.0 || !std::isfinite(value)) return max_digits;
  const double digits = std::floor(math::log10(std::abs(value))) - std::floor(math::log10(*tolerance)) + 1.0;
  return static_cast<int>(std::clamp(digits, 1.0, static_cast<double>(max_digits)));
}

std::string deserved(double value, const std::optional<double>& tolerance, int digits) {
  const double size = std::abs(value);
  if (!tolerance || !(*tolerance > 0.0 && *tolerance < size) || !std::isfinite(size)) return significant(value, digits);
  const int last = static_cast<int>(std::floor(math::log10(*tolerance)));
  if (size < 1e-4 || last < -12) return significant(value, deserved_digits(value, tolerance, 12));
  // Round to the decimal place of the tolerance's leading digit.
  const double unit = math::pow(10.0, last);
  return last < 0 ? fmt::format("{:.{}f}", value, -last) : fmt::format("{:.0f}", std::round(value / unit) * unit);
}

}  // namespace hapbench
