#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Axes of a grid or of a sample: a scenario field and the values that it takes over a batch of runs.
namespace hapbench {

/// Maximum number of cases of a batch, and of values of an axis.
inline constexpr std::size_t kMaxRuns = 1'000'000;

/// An interval of values. A sample draws from it; a grid divides it into equal steps or equal ratios.
struct Range {
  double from = 0.0, to = 0.0;
  bool logarithmic = false;

  /// Returns the value at the fraction `part` / `whole` of the interval, in [0, 1]. A logarithmic range is divided on a
  /// logarithmic scale. Returns both ends exactly, and never a value outside the interval.
  double value_at(double part, double whole = 1.0) const;
};

/// A scenario field and its values. Values are written as in --set: numbers as their shortest decimals, objects
/// and lists as compact JSON.
struct Axis {
  std::string path;                      ///< dotted path of the field, as in --set
  std::vector<std::string> values = {};  ///< listed values; not used if there is a range
  std::optional<Range> range = {};       ///< interval of values; replaces the listed values
  std::size_t steps = 0;                 ///< number of values of the range on a grid; 0 for a sample
  bool whole = false;                    ///< true: numbers of the range are rounded to integers
  bool named = false;                    ///< true: values are labels for the caller and do not override a field

  /// Further changes to all cases that have a given value of the axis: overrides, and a factor `stride` by which
  /// TimeFields::stride is multiplied.
  struct Along {
    std::vector<std::string> overrides;
    std::int64_t stride = 1;
  };
  std::vector<Along> along = {};  ///< one entry for each listed value; empty: no further changes
  std::string option = "--vary";  ///< option that gave the axis, for messages

  /// Returns the number of values; 0 for a range of a sample.
  std::size_t size() const { return range ? steps : values.size(); }
  /// Returns value i of a list or a grid. Precondition: i < size().
  std::string value(std::size_t i) const;
  /// Returns the index of the listed value at a coordinate in [0, 1). Each value has an equal share of this
  /// interval. Precondition: the axis has listed values.
  std::size_t index_at(double coordinate) const;
  /// Returns the value at a coordinate in [0, 1): for a range, the value at this fraction; for a list, the value at
  /// index_at().
  std::string value_at(double coordinate) const;
};

/// Parses the argument of --vary, or of another option. `option` is the name of the option, for messages. Forms:
/// - "path=a:b:n": n numbers from a to b in equal steps, including both ends;
/// - "path=a:b:n:log": n numbers in equal ratios;
/// - "path=v,w,…": listed numbers, names, JSON objects or lists;
/// - "path=all": all names that the field accepts.
/// With `sampled`, "path=a:b" and "path=a:b:log" replace the first two forms. A range of an integer field gives
/// integers, except if the field belongs to an entry of a list. Throws InputError if the argument has another form.
/// Does not check whether the scenario has the field or accepts the values.
Axis parse_axis(const std::string& text, bool sampled = false, const std::string& option = "--vary");

/// Path of the special axis whose values are names of scenes.
inline constexpr const char* kSceneAxis = "scenario";

/// Returns a value as axes store it: a number as its shortest decimal, an object or a list as compact JSON, other text
/// unchanged. Throws InputError for an empty text, a text with a line break, and a text that begins like JSON but is
/// not valid JSON.
std::string axis_value(std::string_view text);

}  // namespace hapbench
