#pragma once

namespace hapbench {

/// Returns `value` rounded to `digits` significant decimal digits, as the nearest double. Example: 0.12345
/// rounded to two digits is 0.12. Infinities and NaN are returned unchanged.
double rounded_to_digits(double value, int digits);

}  // namespace hapbench
