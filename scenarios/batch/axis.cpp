#include "scenarios/batch/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "results/io/json_text.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Largest magnitude of a range's end: beyond the range of every field, and small enough that sums of weighted ends do
/// not overflow.
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
  if (!number || std::abs(*number) > kLargestEnd)
    refuse_axis(text, fmt::format("got \"{}\" for an end of the range", word), "a finite number");
  return *number;
}

/// The i-th of the values 0 ... last between two ends, which are returned exactly. Weighting the ends, rather than
/// adding steps, gives 0.3 and not 0.30000000000000004 for the third of ten steps from 0 to 1.
double linear_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp((a * (last - i) + b * i) / last, std::min(a, b), std::max(a, b));
}

double value_between(const Range& range, double i, double last) {
  const double a = range.from, b = range.to;
  if (!range.logarithmic || i == 0.0 || i == last) return linear_value(a, b, i, last);
  // Decimal logarithms make decades exact.
  return std::clamp(math::pow(10.0, linear_value(math::log10(a), math::log10(b), i, last)), std::min(a, b),
                    std::max(a, b));
}

/// The parts of "a:b", or of "a:b:n" for a grid, optionally followed by ":log".
struct RangeText {
  Range range;
  std::string_view count;  ///< empty for a sample
};

RangeText read_range(const std::string& text, std::string_view words, bool sampled) {
  const Words parts = parts_of(words, ':');
  const std::size_t least = sampled ? 2 : 3;
  if (sampled && parts.size() > 2 && whole_number(parts[2]))
    refuse_axis(text, "got a number of values beside --sample, which has its own", "a:b or a:b:log");
  if (!sampled && parts.size() == 2)
    refuse_axis(text, "got 2 parts between colons", "a:b:n or a:b:n:log; a:b and a:b:log with --sample");
  if (parts.size() != least && parts.size() != least + 1) {
    refuse_axis(text, fmt::format("got {} parts between colons", parts.size()),
                sampled ? "a:b or a:b:log" : "a:b:n or a:b:n:log");
  }
  RangeText read{{range_end(text, parts[0]), range_end(text, parts[1]), parts.size() > least},
                 sampled ? std::string_view() : parts[2]};
  if (!read.range.logarithmic) return read;
  if (parts.back() != "log") refuse_axis(text, fmt::format("got \"{}\"", parts.back()), "\"log\" or nothing");
  if (!(read.range.from > 0.0 && read.range.to > 0.0)) {
    refuse_axis(text, fmt::format("got ends {} and {} of a logarithmic range", read.range.from, read.range.to),
                "numbers > 0");
  }
  return read;
}

std::size_t steps_of(const std::string& text, std::string_view word) {
  const auto n = whole_number(word);
  if (!n || *n < 2 || *n > kMostRuns)
    refuse_axis(text, fmt::format("got \"{}\" values", word), fmt::format("an integer 2 ... {}", kMostRuns));
  return *n;
}

/// The parts between commas that stand outside of JSON's brackets and strings.
Words listed_words(std::string_view list) {
  Words words;
  std::size_t begin = 0, depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const char c = list[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
    } else if (in_string) {
      continue;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    } else if (c == ',' && depth == 0) {
      words.push_back(list.substr(begin, i - begin));
      begin = i + 1;
    }
  }
  words.push_back(list.substr(begin));
  return words;
}

bool begins_json(std::string_view text) {
  return text.starts_with('{') || text.starts_with('[') || text.starts_with('"');
}

std::vector<std::string> listed_values(const std::string& text, std::string_view list) {
  const Words words = listed_words(list);
  if (words.size() > kMostRuns)
    refuse_axis(text, fmt::format("got {} values", words.size()), fmt::format("at most {}", kMostRuns));
  std::vector<std::string> values;
  for (const std::string_view word : words) {
    try {
      values.push_back(axis_value(word));
    } catch (const InputError& error) {
      refuse_axis(text, error.problem(), "numbers, names and JSON, separated by commas");
    }
  }
  return values;
}

/// The description of a field by its path; null when there is none, or when it is in the entries of a list.
const ValueGuide* guide_at(const ValueGuide& guide, std::string_view path) {
  const std::size_t dot = std::min(path.find('.'), path.size());
  for (const FieldGuide& field : guide.fields) {
    if (field.name != path.substr(0, dot)) continue;
    return dot == path.size() ? &field.value : guide_at(field.value, path.substr(dot + 1));
  }
  for (const ValueGuide& choice : guide.choices)
    if (const ValueGuide* found = guide_at(choice, path)) return found;
  return nullptr;
}

Axis read_axis(const std::string& text, bool sampled) {
  const std::size_t equals = text.find('=');
  Axis axis{text.substr(0, equals)};
  constexpr const char* kPathCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.$";
  if (equals == std::string::npos || axis.path.empty() ||
      axis.path.find_first_not_of(kPathCharacters) != std::string::npos) {
    refuse_axis(text, "has no path",
                sampled ? "path=a:b, path=a:b:log or path=v,w, as in time.step_s=0.0001:0.001"
                        : "path=a:b:n, path=a:b:n:log or path=v,w, as in time.step_s=0.0001:0.001:10");
  }
  const std::string_view values = std::string_view(text).substr(equals + 1);
  if (std::any_of(values.begin(), values.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    refuse_axis(text, "has control characters", "numbers, names and JSON");
  const bool is_range =
      !begins_json(values) && values.find(',') == std::string_view::npos && values.find(':') != std::string_view::npos;
  if (!is_range) {
    axis.values = listed_values(text, values);
    return axis;
  }
  const RangeText read = read_range(text, values, sampled);
  axis.range = read.range;
  if (!sampled) axis.steps = steps_of(text, read.count);
  return axis;
}

}  // namespace

double Range::value_at(double part) const {
  return value_between(*this, part, 1.0);
}

Axis parse_axis(const std::string& text, bool sampled) {
  Axis axis = read_axis(text, sampled);
  const ValueGuide* guide = guide_at(scenario_guide(), axis.path);
  if (guide == nullptr) return axis;
  axis.whole = axis.range && guide->schema.value("type", Json()) == "integer";
  if (axis.values == std::vector<std::string>{"all"} && guide->schema.contains("enum"))
    axis.values = guide->schema["enum"].get<std::vector<std::string>>();
  return axis;
}

std::string axis_value(std::string_view text) {
  if (text.empty()) throw InputError("got an empty value");
  if (const auto number = finite_number(text)) return number_text(*number);
  return begins_json(text) ? parse_json(std::string(text)).dump() : std::string(text);
}

std::string Axis::value(std::size_t i) const {
  if (!range) return values[i];
  const double value = value_between(*range, static_cast<double>(i), static_cast<double>(steps - 1));
  return number_text(whole ? std::round(value) : value);
}

std::size_t Axis::place_at(double coordinate) const {
  const auto count = static_cast<double>(values.size());
  return std::min(static_cast<std::size_t>(coordinate * count), values.size() - 1);
}

std::string Axis::value_at(double coordinate) const {
  if (!range) return values[place_at(coordinate)];
  const double value = range->value_at(coordinate);
  return number_text(whole ? std::round(value) : value);
}

}  // namespace hapbench
