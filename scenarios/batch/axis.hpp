#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The values that a field takes over a batch of runs: an axis of a grid or of a sample.
namespace hapbench {

/// Most cases, and values of an axis.
inline constexpr std::size_t kMostRuns = 1'000'000;

/// An interval to sample, or to divide into equal steps or ratios.
struct Range {
  double from = 0.0, to = 0.0;
  bool logarithmic = false;

  /// The value at the fraction part / whole in [0, 1] of the interval, or of its logarithm. Returns both ends exactly
  /// and never a value outside.
  double value_at(double part, double whole = 1.0) const;
};

/// A field and its values: as in --set, numbers as shortest decimals, objects and lists as compact JSON.
struct Axis {
  std::string path;                      ///< dotted, as in --set
  std::vector<std::string> values = {};  ///< listed values, unless there is a range
  std::optional<Range> range = {};       ///< replaces listed values
  std::size_t steps = 0;                 ///< number of values of a range on a grid
  bool whole = false;                    ///< numbers of the range are rounded to integers
  bool named = false;                    ///< values are names, for whoever asks, and no overrides

  /// Changes that go with a value of the axis: further overrides, and the TimeFields::stride of its runs.
  struct Along {
    std::vector<std::string> overrides;
    std::int64_t stride = 1;
  };
  std::vector<Along> along = {};  ///< of each listed value; empty: nothing

  /// Number of values; 0 for the range of a sample.
  std::size_t size() const { return range ? steps : values.size(); }
  /// Precondition: i < size().
  std::string value(std::size_t i) const;
  /// Index of the listed value at a coordinate in [0, 1): each has an equal share of the interval. Precondition: the
  /// axis has listed values.
  std::size_t place_at(double coordinate) const;
  /// The value at a coordinate in [0, 1): of a range the value at that fraction, of a list the value at place_at().
  std::string value_at(double coordinate) const;
};

/// Reads "path=a:b:n" (n numbers from a to b, both exactly, in equal steps), "path=a:b:n:log" (in equal ratios) or
/// "path=v,w,…" (numbers, names, JSON objects and lists); with `sampled`, "path=a:b" or "path=a:b:log" in place of the
/// first two. "path=all" stands for all names that the field takes. The range of a field of integers, entries of lists
/// aside, has integers. Throws InputError. Whether a scenario has such a field and accepts the values is not checked.
Axis parse_axis(const std::string& text, bool sampled = false);

/// The path of the axis whose values name scenes.
inline constexpr const char* kSceneAxis = "scenario";

/// Returns a value in the spelling that axes have: a number as its shortest decimal, an object or a list as compact
/// JSON, other text as it is. Throws InputError for text that begins as JSON and is none, and for an empty text.
std::string axis_value(std::string_view text);

}  // namespace hapbench
