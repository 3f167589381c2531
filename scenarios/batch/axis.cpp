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

/// Largest magnitude of an end of a range: beyond the limits of every field, and small enough that sums of
/// weighted ends do not overflow.
constexpr double kMaxRangeEnd = 1e300;

[[noreturn]] void refuse_axis(const std::string& problem, const std::string& allowed) {
  throw InputError(problem + "; allowed: " + allowed);
}

/// Returns value i of equally spaced values from a (i = 0) to b (i = last). i may be a fraction. Both ends are exact.
/// The result is a weighted mean of the ends, because adding steps accumulates rounding errors: the weighted mean gives
/// 0.3, not 0.30000000000000004, for the third of ten steps from 0 to 1.
double linear_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp((a * (last - i) + b * i) / last, std::min(a, b), std::max(a, b));
}

/// Returns the allowed forms of a range, for error messages.
std::string range_forms(bool sampled) {
  if (sampled) return "a:b, or a:b:log for equal ratios; --sample gives the number of points";
  return fmt::format("a:b:n, or a:b:n:log for equal ratios, with an integer n of 2 ... {} values", kMaxRuns);
}

/// Throws InputError about the parts of a range after "a:b", which give the number of values and the scale. If these
/// parts hold a number and "log" in another form, such as "5log" or "log:5", suggests the range that was probably
/// meant.
[[noreturn]] void refuse_range(const Words& parts, const std::string& problem, bool sampled) {
  std::string count;
  for (std::size_t i = 2; i < parts.size(); ++i) count += parts[i];
  const std::size_t log = count.find("log");
  const bool has_log = log != std::string::npos;
  if (has_log) count.erase(log, 3);
  const std::uint64_t n = whole_number(count).value_or(0);
  const bool is_count = n >= 2 && n <= kMaxRuns;
  std::string hint;
  if (parts.size() >= 2 && (sampled ? count.empty() || is_count : is_count))
    hint = fmt::format("; nearest valid form: \"{}:{}{}{}\"", parts[0], parts[1], sampled ? "" : ":" + count,
                       has_log ? ":log" : "");
  throw InputError(fmt::format("{}{}; allowed: {}", problem, hint, range_forms(sampled)));
}

/// Parses "a:b" for a sample or "a:b:n" for a grid, optionally followed by ":log".
void read_range(std::string_view text, bool sampled, Axis& axis) {
  const Words parts = parts_of(text, ':');
  const std::size_t min_parts = sampled ? 2 : 3;
  if (parts.size() != min_parts && parts.size() != min_parts + 1)
    refuse_range(parts, fmt::format("got {} parts between colons", parts.size()), sampled);
  // Parse the ends and the scale.
  const auto end = [](std::string_view number_text) {
    const auto number = finite_number(number_text);
    if (number && std::abs(*number) <= kMaxRangeEnd) return *number;
    refuse_axis(fmt::format("got \"{}\" for an end of the range", number_text), "a finite number");
  };
  axis.range = {end(parts[0]), end(parts[1]), parts.size() > min_parts};
  if (axis.range->logarithmic && parts.back() != "log")
    refuse_range(parts, fmt::format("got \"{}\" for \"log\"", parts.back()), sampled);
  const auto [from, to, logarithmic] = *axis.range;
  if (logarithmic && !(from > 0.0 && to > 0.0))
    refuse_axis(fmt::format("got ends {} and {} of a logarithmic range", from, to), "numbers > 0");
  if (sampled) return;
  // Parse the number of values of a grid.
  axis.steps = whole_number(parts[2]).value_or(0);
  if (axis.steps < 2 || axis.steps > kMaxRuns)
    refuse_range(parts, fmt::format("got \"{}\" for the number of values n", parts[2]), sampled);
}

bool begins_json(std::string_view text) {
  return text.starts_with('{') || text.starts_with('[') || text.starts_with('"');
}

/// Splits a list at commas that are not part of a JSON value.
std::vector<std::string> split_list(std::string_view list) {
  std::vector<std::string> values;
  bool is_whole = true;
  for (const std::string_view part : parts_of(list, ',')) {
    if (is_whole)
      values.emplace_back(part);
    else
      values.back().append(",").append(part);
    is_whole = !begins_json(values.back()) || Json::accept(values.back());
  }
  if (values.size() > kMaxRuns)
    refuse_axis(fmt::format("got {} values", values.size()), fmt::format("at most {}", kMaxRuns));
  return values;
}

/// Parses the argument of --vary, without knowledge of the field.
Axis read_axis(const std::string& text, bool sampled) {
  const std::size_t equals = text.find('=');
  Axis axis{text.substr(0, equals)};
  constexpr const char* kPathCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.$";
  if (equals == std::string::npos || axis.path.empty() ||
      axis.path.find_first_not_of(kPathCharacters) != std::string::npos) {
    refuse_axis("has no path", sampled ? "path=a:b, path=a:b:log or path=v,w, such as time.step_s=0.0001:0.001"
                                       : "path=a:b:n, path=a:b:n:log or path=v,w, such as time.step_s=0.0001:0.001:10");
  }
  // The values are a range or a list.
  const std::string_view values = std::string_view(text).substr(equals + 1);
  if (std::ranges::any_of(values, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    refuse_axis("has control characters", "numbers, names and JSON");
  const bool has_colon = !begins_json(values) && values.find(':') != values.npos;
  if (has_colon && values.find(',') != values.npos &&
      values.find_first_not_of("0123456789.,:+-eE") == values.npos)  // not a list of names with colons
    refuse_axis("got a range with commas", "decimal points, such as path=1.5:2.5:3, or values separated by commas");
  if (has_colon && values.find(',') == values.npos) {
    read_range(values, sampled, axis);
    return axis;
  }
  for (const std::string& value : split_list(values)) {
    try {
      axis.values.push_back(axis_value(value));
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
  // Decimal logarithms give exact powers of ten.
  return std::clamp(math::pow(10.0, linear_value(math::log10(from), math::log10(to), part, whole)), std::min(from, to),
                    std::max(from, to));
}

std::string axis_value(std::string_view text) {
  if (text.empty()) throw InputError("got an empty value");
  if (text.find_first_of("\r\n") != text.npos) throw InputError("got a value with a line break");
  if (const auto number = finite_number(text)) return cell_text(*number);
  return begins_json(text) ? parse_json(std::string(text)).dump() : std::string(text);
}

Axis parse_axis(const std::string& text, bool sampled, const std::string& option) {
  Axis axis;
  try {
    axis = read_axis(text, sampled);
  } catch (const InputError& error) {
    constexpr std::size_t kMaxShownLength = 200;
    const std::string shown = text.size() > kMaxShownLength ? text.substr(0, kMaxShownLength) + "..." : text;
    fail_in({.about_options = {option}}, fmt::format("{} \"{}\": {}", option, shown, error.problem()));
  }
  axis.option = option;
  // The schema of the field states whether its values are integers, and which names "all" stands for.
  const std::vector<ScenarioField> fields = scenario_fields();
  const auto field = std::ranges::find(fields, axis.path, &ScenarioField::path);
  if (field == fields.end()) return axis;
  const Json& schema = field->field->value.schema;
  axis.whole = axis.range && schema.value("type", Json()) == "integer";
  if (axis.values == std::vector<std::string>{"all"} && schema.contains("enum"))
    axis.values = schema["enum"].get<std::vector<std::string>>();
  return axis;
}

std::string Axis::value(std::size_t i) const {
  return range ? range_text(*this, static_cast<double>(i), static_cast<double>(steps - 1)) : values[i];
}

std::size_t Axis::index_at(double coordinate) const {
  const auto count = static_cast<double>(values.size());
  return std::min(static_cast<std::size_t>(coordinate * count), values.size() - 1);
}

std::string Axis::value_at(double coordinate) const {
  return range ? range_text(*this, coordinate, 1.0) : values[index_at(coordinate)];
}

}  // namespace hapbench
