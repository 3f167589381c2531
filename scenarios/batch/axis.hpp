#pragma once

#include <optional>
#include <string>
#include <vector>

namespace hapbench {

/// An interval to sample.
struct Range {
  double from = 0.0;
  double to = 0.0;
  bool logarithmic = false;

  /// The value at a part of the way in [0, 1], in the logarithm for a logarithmic range: the ends exactly, and never
  /// outside.
  double value_at(double part) const;
};

/// One field that a sweep varies and the values it takes.
struct Axis {
  std::string path;                 ///< dotted, as in --set
  std::vector<std::string> values;  ///< as in --set; numbers as shortest decimals, nothing that CSV would have to quote
  std::optional<Range> range = {};  ///< in place of values, for a sample alone
};

/// Reads "path=a:b:n" (n numbers from a to b, both exactly, in equal steps), "path=a:b:n:log" (in equal ratios) or
/// "path=v,w,…" (numbers or texts). Throws InputError. Whether the field exists and takes the values is for the
/// scenario to say.
Axis parse_axis(const std::string& text);

/// The same for a sample: "path=a:b", "path=a:b:log" or "path=v,w,…".
Axis parse_sampled_axis(const std::string& text);

/// The value of an axis of a sample at a coordinate in [0, 1): of a range, the value at that part of the way; of a
/// list, each value on an equal share of the interval.
std::string value_at(const Axis& axis, double coordinate);

}  // namespace hapbench
