#include "scenarios/thesis_claims/wording.hpp"

#include <fmt/format.h>

namespace hapbench {

std::string plain(double number) {
  std::string text = fmt::format("{:g}", number);
  // An exponent without its leading zero.
  const auto exponent = text.find("e-0");
  if (exponent != std::string::npos) text.erase(exponent + 2, 1);
  return text;
}

std::string percent(double share) {
  return plain(100.0 * share) + " %";
}

std::string in_words(double number) {
  constexpr std::pair<double, const char*> kWords[] = {
      {0.5, "half"}, {1.0, "one"}, {2.0, "two"}, {5.0, "five"}, {10.0, "ten"}};
  for (const auto& [value, word] : kWords) {
    if (value == number) return word;
  }
  return plain(number);
}

}  // namespace hapbench
