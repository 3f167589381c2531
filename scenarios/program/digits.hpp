#pragma once

#include <optional>
#include <string>

/// Formats numbers with the digits that are significant at their tolerance. A tolerance is the largest error of
/// a number, in its unit.
namespace hapbench {

/// Returns a number with `digits` significant digits; "-" for NaN and infinities.
std::string significant(double value, int digits = 4);
/// Returns an upper bound, which is above 0, rounded up to `digits` significant digits.
std::string significant_up(double bound, int digits);
inline constexpr int kAllDigits = 17;
/// Returns a number rounded to `digits` significant digits, in the shorter of the notations "43373200" and "4.34e+17".
/// A magnitude from 1e-4 to 1 is always written without an exponent. Returns "-" for NaN and infinities. With
/// kAllDigits the text reads back as the same double.
std::string rounded_text(double value, int digits);
/// Returns the number of significant digits of `value` from its leading digit down to the decimal place of the
/// tolerance's leading digit, from 1 to `max_digits`. If the tolerance is unknown or not above 0, or if `value` is 0 or
/// not finite, returns `max_digits`.
int deserved_digits(double value, const std::optional<double>& tolerance, int max_digits);
/// Returns the bound of a number whose error is not smaller than the number (is_only_bounded()): the sum of magnitude
/// and tolerance, rounded up to one significant digit. The text is "<= 0.4", or "0 +- 0.4" for a negative number. The
/// HTML page of the command `report` has the same text (known_number of hapbench_report).
std::string bound_text(double value, double tolerance);
/// Returns a number rounded to the decimal place of the leading digit of its tolerance, without an exponent for
/// values of at least 1e-4. Returns `digits` significant digits if the tolerance is unknown or not above 0, and
/// bound_text() if the number is only bounded.
std::string deserved(double value, const std::optional<double>& tolerance, int digits = 4);
/// The direction in which a number is rounded for a text.
enum class Rounding { nearest, down, up };
/// Returns a number as deserved() does, but rounded down or up, so that the text is on the safe side of a limit. It has
/// at least one digit, whatever the tolerance.
std::string deserved_on_side(double value, const std::optional<double>& tolerance, int digits, Rounding rounding);
/// Returns "MEAN +- SPREAD", both to the second significant digit of the spread. Returns deserved(mean, tolerance,
/// digits) instead if there is no spread, if the spread is less than the tolerance of the mean, or if the mean is not
/// larger than its tolerance. `digits`: significant digits if the tolerance is unknown.
std::string with_spread(double mean, const std::optional<double>& spread, const std::optional<double>& tolerance,
                        int digits = 4);

}  // namespace hapbench
