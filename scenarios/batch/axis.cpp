#include "scenarios/batch/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Largest magnitude of a range's end: beyond the range of every field, and small enough that sums of weighted ends do
/// not overflow.
constexpr double kLargestEnd = 1e300;

[[noreturn]] void refuse_axis(const std::string& problem, const std::string& allowed) {
  throw InputError(problem + "; allowed: " + allowed);
}

/// The i-th of the values 0 ... last between two ends, which are returned exactly. Weighting the ends, rather than
/// adding steps, gives 0.3 and not 0.30000000000000004 for the third of ten steps from 0 to 1.
double linear_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp((a * (last - i) + b * i) / last, std::min(a, b), std::max(a, b));
}

/// Reads "a:b", or "a:b:n" for a grid, optionally followed by ":log".
void read_range(std::string_view words, bool sampled, Axis& axis) {
  const Words parts = parts_of(words, ':');
  const std::size_t least = sampled ? 2 : 3;
  if (parts.size() != least && parts.size() != least + 1) {
    refuse_axis(fmt::format("got {} parts between colons", parts.size()),
                sampled ? "a:b or a:b:log" : "a:b:n or a:b:n:log; a:b and a:b:log with --sample");
  }
  const auto end = [](std::string_view word) {
    const auto number = finite_number(word);
    if (number && std::abs(*number) <= kLargestEnd) return *number;
    refuse_axis(fmt::format("got \"{}\" for an end of the range", word), "a finite number");
  };
  axis.range = {end(parts[0]), end(parts[1]), parts.size() > least};
  if (axis.range->logarithmic && parts.back() != "log")
    refuse_axis(fmt::format("got \"{}\"", parts.back()),
                sampled ? "\"log\" or nothing, as --sample says how many" : "\"log\" or nothing");
  const auto [from, to, logarithmic] = *axis.range;
  if (logarithmic && !(from > 0.0 && to > 0.0))
    refuse_axis(fmt::format("got ends {} and {} of a logarithmic range", from, to), "numbers > 0");
  if (sampled) return;
  axis.steps = whole_number(parts[2]).value_or(0);
  if (axis.steps < 2 || axis.steps > kMostRuns)
    refuse_axis(fmt::format("got \"{}\" values", parts[2]), fmt::format("an integer 2 ... {}", kMostRuns));
}

bool begins_json(std::string_view text) {
  return text.starts_with('{') || text.starts_with('[') || text.starts_with('"');
}

/// The parts between commas that stand outside of JSON.
std::vector<std::string> listed_words(std::string_view list) {
  std::vector<std::string> words;
  bool is_whole = true;
  for (const std::string_view part : parts_of(list, ',')) {
    if (is_whole)
      words.emplace_back(part);
    else
      words.back().append(",").append(part);
    is_whole = !begins_json(words.back()) || Json::accept(words.back());
  }
  if (words.size() > kMostRuns)
    refuse_axis(fmt::format("got {} values", words.size()), fmt::format("at most {}", kMostRuns));
  return words;
}

/// parse_axis without what is known of the field.
Axis read_axis(const std::string& text, bool sampled) {
  const std::size_t equals = text.find('=');
  Axis axis{text.substr(0, equals)};
  constexpr const char* kPathCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.$";
  if (equals == std::string::npos || axis.path.empty() ||
      axis.path.find_first_not_of(kPathCharacters) != std::string::npos) {
    refuse_axis("has no path", sampled ? "path=a:b, path=a:b:log or path=v,w, as in time.step_s=0.0001:0.001"
                                       : "path=a:b:n, path=a:b:n:log or path=v,w, as in time.step_s=0.0001:0.001:10");
  }
  const std::string_view values = std::string_view(text).substr(equals + 1);
  if (std::ranges::any_of(values, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    refuse_axis("has control characters", "numbers, names and JSON");
  if (!begins_json(values) && values.find(',') == values.npos && values.find(':') != values.npos) {
    read_range(values, sampled, axis);
    return axis;
  }
  for (const std::string& word : listed_words(values)) {
    try {
      axis.values.push_back(axis_value(word));
    } catch (const InputError& error) {
      refuse_axis(error.problem(), "numbers, names and JSON, separated by commas");
    }
  }
  return axis;
}

std::string range_text(const Axis& axis, double part, double whole) {
  const double value = axis.range->value_at(part, whole);
  return cell_text(axis.whole ? std::round(value) : value);
}

}  // namespace

double Range::value_at(double part, double whole) const {
  if (!logarithmic || part == 0.0 || part == whole) return linear_value(from, to, part, whole);
  // Decimal logarithms make decades exact.
  return std::clamp(math::pow(10.0, linear_value(math::log10(from), math::log10(to), part, whole)), std::min(from, to),
                    std::max(from, to));
}

std::string axis_value(std::string_view text) {
  if (text.empty()) throw InputError("got an empty value");
  if (const auto number = finite_number(text)) return cell_text(*number);
  return begins_json(text) ? parse_json(std::string(text)).dump() : std::string(text);
}

Axis parse_axis(const std::string& text, bool sampled) {
  Axis axis;
  try {
    axis = read_axis(text, sampled);
  } catch (const InputError& error) {
    constexpr std::size_t kLongest = 200;
    const std::string shown = text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
    fail_in({.about_options = {"--vary"}}, fmt::format("--vary \"{}\": {}", shown, error.problem()));
  }
  const std::vector<PlacedField> fields = placed_fields();
  const auto place = std::ranges::find(fields, axis.path, &PlacedField::path);
  if (place == fields.end()) return axis;
  const Json& schema = place->field->value.schema;
  axis.whole = axis.range && schema.value("type", Json()) == "integer";
  if (axis.values == std::vector<std::string>{"all"} && schema.contains("enum"))
    axis.values = schema["enum"].get<std::vector<std::string>>();
  return axis;
}

std::string Axis::value(std::size_t i) const {
  return range ? range_text(*this, static_cast<double>(i), static_cast<double>(steps - 1)) : values[i];
}

std::size_t Axis::place_at(double coordinate) const {
  const auto count = static_cast<double>(values.size());
  return std::min(static_cast<std::size_t>(coordinate * count), values.size() - 1);
}

std::string Axis::value_at(double coordinate) const {
  return range ? range_text(*this, coordinate, 1.0) : values[place_at(coordinate)];
}

}  // namespace hapbench
