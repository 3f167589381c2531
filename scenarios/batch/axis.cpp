#include "scenarios/batch/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "results/io/number_text.hpp"
#include "scenarios/batch/grid.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

/// Beyond every field's range, and far enough from the largest double for sums of weighted ends.
constexpr double kLargestEnd = 1e300;

[[noreturn]] void refuse_axis(const std::string& text, const std::string& problem, const std::string& allowed) {
  constexpr std::size_t kLongest = 200;
  const std::string shown = text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
  throw InputError(fmt::format("--vary \"{}\": {}; allowed: {}", shown, problem, allowed));
}

std::string number_text(double value) {
  return std::string(std::string_view(NumberText(value)));
}

double range_end(const std::string& text, std::string_view word) {
  const auto number = finite_number(word);
  if (!number || std::abs(*number) > kLargestEnd) {
    refuse_axis(text, fmt::format("got \"{}\" for an end of the range", word), "a finite number");
  }
  return *number;
}

/// Value i of 0 ... last between the ends, which are exact. Weighting them, rather than adding up steps, gives 0.3 and
/// not 0.30000000000000004 for the third of ten steps from 0 to 1.
double linear_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp((a * (last - i) + b * i) / last, std::min(a, b), std::max(a, b));
}

/// Decimal logarithms, so that decades come out as such.
double logarithmic_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp(std::pow(10.0, linear_value(std::log10(a), std::log10(b), i, last)), std::min(a, b),
                    std::max(a, b));
}

std::vector<std::string> range_values(const std::string& text, std::string_view range) {
  const Words parts = parts_of(range, ':');
  if (parts.size() != 3 && parts.size() != 4) {
    refuse_axis(text, fmt::format("got {} parts between colons", parts.size()), "a:b:n or a:b:n:log");
  }
  const double a = range_end(text, parts[0]), b = range_end(text, parts[1]);
  const auto n = whole_number(parts[2]);
  if (!n || *n < 2 || *n > kMostRuns) {
    refuse_axis(text, fmt::format("got \"{}\" values", parts[2]), fmt::format("an integer 2 ... {}", kMostRuns));
  }
  const bool logarithmic = parts.size() == 4;
  if (logarithmic && parts[3] != "log") refuse_axis(text, fmt::format("got \"{}\"", parts[3]), "\"log\" or nothing");
  if (logarithmic && !(a > 0.0 && b > 0.0)) {
    refuse_axis(text, fmt::format("got ends {} and {} of a logarithmic range", a, b), "numbers > 0");
  }
  const auto value = logarithmic ? logarithmic_value : linear_value;
  std::vector<std::string> values;
  for (std::size_t i = 0; i < *n; ++i) {
    values.push_back(number_text(value(a, b, static_cast<double>(i), static_cast<double>(*n - 1))));
  }
  return values;
}

std::vector<std::string> listed_values(const std::string& text, std::string_view list) {
  const Words words = parts_of(list, ',');
  if (words.size() > kMostRuns) {
    refuse_axis(text, fmt::format("got {} values", words.size()), fmt::format("at most {}", kMostRuns));
  }
  std::vector<std::string> values;
  for (const std::string_view word : words) {
    if (word.empty()) refuse_axis(text, "got an empty value", "numbers or texts separated by commas");
    const auto number = finite_number(word);
    values.push_back(number ? number_text(*number) : std::string(word));
  }
  return values;
}

}  // namespace

Axis parse_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  Axis axis{text.substr(0, equals), {}};
  constexpr const char* kPathCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.$";
  if (equals == std::string::npos || axis.path.empty() ||
      axis.path.find_first_not_of(kPathCharacters) != std::string::npos) {
    refuse_axis(text, "has no path", "path=a:b:n, path=a:b:n:log or path=v,w, as in time.step_s=0.0001:0.001:10");
  }
  const std::string_view values = std::string_view(text).substr(equals + 1);
  const auto needs_quotes = [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '"'; };
  if (std::any_of(values.begin(), values.end(), needs_quotes)) {
    refuse_axis(text, "has quotes or control characters", "numbers or plain texts");
  }
  const bool is_range = values.find(',') == std::string_view::npos && values.find(':') != std::string_view::npos;
  axis.values = is_range ? range_values(text, values) : listed_values(text, values);
  return axis;
}

}  // namespace hapbench
