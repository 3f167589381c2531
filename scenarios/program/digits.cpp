#include "scenarios/program/digits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "results/io/columns.hpp"
#include "scenarios/batch/number_with_error.hpp"
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

namespace {

/// Returns a number rounded to the decimal place 10^last, without an exponent.
std::string to_digit(double value, int last) {
  const double unit = math::pow(10.0, last);
  return last < 0 ? fmt::format("{:.{}f}", value, -last) : fmt::format("{:.0f}", std::round(value / unit) * unit);
}

/// Returns the decimal exponent of the leading digit.
int leading_digit(double value) {
  return static_cast<int>(std::floor(math::log10(value)));
}

constexpr double kSmallest = 1e-4;  ///< smaller numbers have an exponent
constexpr int kLastDigit = -12;     ///< last decimal place of a number without an exponent

}  // namespace

std::string significant_up(double bound, int digits) {
  const double unit = math::pow(10.0, leading_digit(bound) - digits + 1);
  // Without the factor 1 - 1e-12, the rounding error of a bound such as 0.3 could give 0.4.
  return significant(std::ceil(bound / unit * (1.0 - 1e-12)) * unit, digits);
}

std::string bound_text(double value, double tolerance) {
  return (value < 0.0 ? "0 +- " : "<= ") + significant_up(std::abs(value) + tolerance, 1);
}

std::string deserved(double value, const std::optional<double>& tolerance, int digits) {
  if (is_only_bounded({value, tolerance})) return bound_text(value, *tolerance);
  if (!tolerance || !(*tolerance > 0.0) || !std::isfinite(value)) return significant(value, digits);
  const int last = leading_digit(*tolerance);
  if (std::abs(value) < kSmallest || last < kLastDigit)
    return significant(value, deserved_digits(value, tolerance, -kLastDigit));
  return to_digit(value, last);
}

std::string deserved_on_side(double value, const std::optional<double>& tolerance, int digits, Rounding rounding) {
  if (rounding == Rounding::nearest) return deserved(value, tolerance, digits);
  if (value == 0.0 || !std::isfinite(value)) return significant(value, digits);
  const int first = leading_digit(std::abs(value));
  const bool is_known = tolerance && *tolerance > 0.0 && std::isfinite(*tolerance);
  const int last = is_known ? std::min(first, leading_digit(*tolerance)) : first - digits + 1;
  // Without the margin of 1e-12, the rounding error of a number such as 0.3 could move it by a whole unit.
  const double unit = math::pow(10.0, last), units = value / unit, margin = 1e-12 * std::abs(units);
  const double rounded = unit * (rounding == Rounding::down ? std::floor(units + margin) : std::ceil(units - margin));
  if (!is_known) return rounded_text(rounded, digits);
  if (std::abs(value) < kSmallest || last < kLastDigit) return significant(rounded, first - last + 1);
  return to_digit(rounded, last);
}

std::string with_spread(double mean, const std::optional<double>& spread, const std::optional<double>& tolerance,
                        int digits) {
  // A spread below the tolerance is not resolved.
  if (!spread || (tolerance && *spread < *tolerance) || is_only_bounded({mean, tolerance}))
    return deserved(mean, tolerance, digits);
  if (!(*spread > 0.0)) return significant(mean, digits) + " +- " + significant(*spread, 2);
  const int last = leading_digit(*spread) - 1;
  if (std::max(std::abs(mean), *spread) >= kSmallest && last >= kLastDigit)
    return fmt::format("{} +- {}", to_digit(mean, last), to_digit(*spread, last));
  const int decimals = std::max(0, leading_digit(std::max(std::abs(mean), *spread)) - last);
  return fmt::format("{:.{}e} +- {}", mean, decimals, significant(*spread, 2));
}

}  // namespace hapbench
