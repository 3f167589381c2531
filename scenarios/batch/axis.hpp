#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hapbench {

/// An interval to sample, or to divide into equal steps or ratios.
struct Range {
  double from = 0.0;
  double to = 0.0;
  bool logarithmic = false;

  /// The value at a part of the way in [0, 1], in the logarithm for a logarithmic range: the ends exactly, and never
  /// outside.
  double value_at(double part) const;
};

/// One field that a sweep varies and the values it takes: as in --set, numbers as shortest decimals, nothing that CSV
/// would have to quote.
struct Axis {
  std::string path;                      ///< dotted, as in --set
  std::vector<std::string> values = {};  ///< listed ones
  std::optional<Range> range = {};       ///< in place of listed ones
  std::size_t steps = 0;                 ///< of a range on a grid: how many values it has

  /// Number of values; 0 for the range of a sample.
  std::size_t size() const { return range ? steps : values.size(); }
  /// Precondition: i < size().
  std::string value(std::size_t i) const;
};

/// Reads "path=a:b:n" (n numbers from a to b, both exactly, in equal steps), "path=a:b:n:log" (in equal ratios) or
/// "path=v,w,…" (numbers or texts). Throws InputError. Whether the field exists and takes the values is for the
/// scenario to say.
Axis parse_axis(const std::string& text);

/// The same for a sample: "path=a:b", "path=a:b:log" or "path=v,w,…".
Axis parse_sampled_axis(const std::string& text);

/// The number of the listed value at a coordinate in [0, 1): each has an equal share of the interval. Precondition:
/// there are any.
std::size_t place_at(const Axis& axis, double coordinate);

/// The value of an axis of a sample at a coordinate in [0, 1): of a range the value at that part of the way, of a list
/// that at its place.
std::string value_at(const Axis& axis, double coordinate);

}  // namespace hapbench
