#include "scenarios/batch/sweep_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "results/io/json_text.hpp"
#include "scenarios/input/input_error.hpp"
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

std::vector<std::string> listed_values(const std::string& text, std::string_view list) {
  const Words words = parts_of(list, ',');
  if (words.size() > kMostRuns)
    refuse_axis(text, fmt::format("got {} values", words.size()), fmt::format("at most {}", kMostRuns));
  std::vector<std::string> values;
  for (const std::string_view word : words) {
    if (word.empty()) refuse_axis(text, "got an empty value", "numbers or texts separated by commas");
    const auto number = finite_number(word);
    values.push_back(number ? number_text(*number) : std::string(word));
  }
  return values;
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
  const auto needs_quotes = [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '"'; };
  if (std::any_of(values.begin(), values.end(), needs_quotes))
    refuse_axis(text, "has quotes or control characters", "numbers or plain texts");
  const bool is_range = values.find(',') == std::string_view::npos && values.find(':') != std::string_view::npos;
  if (!is_range) {
    axis.values = listed_values(text, values);
    return axis;
  }
  const RangeText read = read_range(text, values, sampled);
  axis.range = read.range;
  if (!sampled) axis.steps = steps_of(text, read.count);
  return axis;
}

void check_paths(const std::vector<Axis>& axes) {
  std::set<std::string> paths;
  for (const Axis& axis : axes) {
    if (paths.insert(axis.path).second) continue;
    throw InputError(fmt::format("--vary: got \"{}\" twice; allowed: each field once", axis.path));
  }
}

}  // namespace

double Range::value_at(double part) const {
  return value_between(*this, part, 1.0);
}

Axis parse_axis(const std::string& text) {
  return read_axis(text, false);
}

Axis parse_sampled_axis(const std::string& text) {
  return read_axis(text, true);
}

std::string Axis::value(std::size_t i) const {
  if (!range) return values[i];
  return number_text(value_between(*range, static_cast<double>(i), static_cast<double>(steps - 1)));
}

std::size_t place_at(const Axis& axis, double coordinate) {
  const auto count = static_cast<double>(axis.values.size());
  return std::min(static_cast<std::size_t>(coordinate * count), axis.values.size() - 1);
}

std::string value_at(const Axis& axis, double coordinate) {
  return axis.range ? number_text(axis.range->value_at(coordinate)) : axis.values[place_at(axis, coordinate)];
}

SweepPoints::SweepPoints(std::vector<Axis> axes) : axes_(std::move(axes)) {
  check_paths(axes_);
  double size = 1.0;  // a double, because the product may overflow integers
  for (const Axis& axis : axes_) size *= static_cast<double>(axis.size());
  if (size > static_cast<double>(kMostRuns))
    throw InputError(fmt::format("--vary: got a grid of {:.7g} runs; allowed: at most {}", size, kMostRuns));
  strides_.resize(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0; size_ *= axes_[a].size()) strides_[a] = size_;
}

SweepPoints::SweepPoints(std::vector<Axis> axes, const Sampling& sampling)
    : axes_(std::move(axes)), sampling_(sampling), size_(sampling.count) {
  check_paths(axes_);
  sample_.emplace(sampling, axes_.size());
}

std::size_t SweepPoints::place(std::size_t run, std::size_t axis) const {
  return sample_ ? place_at(axes_[axis], sample_->at(run, axis)) : run / strides_[axis] % axes_[axis].size();
}

std::size_t SweepPoints::run(std::size_t number, const std::vector<std::size_t>& order) const {
  std::size_t run = 0;
  for (std::size_t i = order.size(); i-- > 0; number /= axes_[order[i]].size())
    run += number % axes_[order[i]].size() * strides_[order[i]];
  return run;
}

std::string SweepPoints::value(std::size_t run, std::size_t axis) const {
  return sample_ ? value_at(axes_[axis], sample_->at(run, axis)) : axes_[axis].value(place(run, axis));
}

std::vector<std::string> SweepPoints::values(std::size_t run) const {
  std::vector<std::string> values(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) values[a] = value(run, a);
  return values;
}

std::vector<std::string> SweepPoints::overrides(std::size_t run) const {
  std::vector<std::string> overrides = values(run);
  for (std::size_t a = 0; a < axes_.size(); ++a) overrides[a].insert(0, axes_[a].path + "=");
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (axes_[a].along.empty()) continue;
    const std::vector<std::string>& more = axes_[a].along[place(run, a)].overrides;
    overrides.insert(overrides.end(), more.begin(), more.end());
  }
  return overrides;
}

std::int64_t SweepPoints::stride(std::size_t run) const {
  std::int64_t stride = 1;
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (!axes_[a].along.empty()) stride *= axes_[a].along[place(run, a)].stride;
  return stride;
}

}  // namespace hapbench
