#pragma once

#include <optional>
#include <string>

/// Numbers with the digits that their tolerance leaves them.
namespace hapbench {

/// A number with `digits` significant digits; "-" for NaN and infinities.
std::string significant(double value, int digits = 4);
/// How many of `most` significant digits a tolerance leaves a number, one at least: down to its own leading one.
int deserved_digits(double value, const std::optional<double>& tolerance, int most);
/// A number with the digits that its tolerance (> 0) leaves it: down to the tolerance's leading one, and without an
/// exponent above 1e-4. `digits` significant ones where no tolerance is known, or it is larger than the number.
std::string deserved(double value, const std::optional<double>& tolerance, int digits = 4);

}  // namespace hapbench
