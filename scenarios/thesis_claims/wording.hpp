#pragma once

#include <string>

/// Thresholds as the rules of claims write them.
namespace hapbench {

/// "half", "one", "two", "five" or "ten"; other numbers as `plain` has them.
std::string in_words(double number);
/// "2 %" for 0.02.
std::string percent(double share);
/// Six digits at most: "0.1", "15", "1e-9".
std::string plain(double number);

}  // namespace hapbench
