#pragma once

namespace hapbench {

/// The double nearest to the decimal number of `digits` significant digits that is nearest to `value`: 0.12345 to two
/// digits is 0.12. Infinities and NaN stay.
double rounded_to_digits(double value, int digits);

}  // namespace hapbench
