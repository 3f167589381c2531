#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/sampling.hpp"

/// The points of a sweep: the fields it varies, and the values they take in each run.
namespace hapbench {

/// Maximum number of runs of a sweep.
inline constexpr std::size_t kMostRuns = 1'000'000;

/// An interval to sample, or to divide into equal steps or ratios.
struct Range {
  double from = 0.0;
  double to = 0.0;
  bool logarithmic = false;

  /// The value at a fraction of the interval in [0, 1], measured in the logarithm if the range is logarithmic. Returns
  /// both ends exactly and never a value outside.
  double value_at(double part) const;
};

/// One field that a sweep varies and the values it takes: as in --set, numbers as shortest decimals, without characters
/// that CSV would have to quote.
struct Axis {
  std::string path;                      ///< dotted, as in --set
  std::vector<std::string> values = {};  ///< listed values, unless there is a range
  std::optional<Range> range = {};       ///< replaces listed values
  std::size_t steps = 0;                 ///< number of values of a range on a grid

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
};

/// Reads "path=a:b:n" (n numbers from a to b, both exactly, in equal steps), "path=a:b:n:log" (in equal ratios) or
/// "path=v,w,…" (numbers or texts). Throws InputError. Does not check whether the scenario has such a field and accepts
/// the values.
Axis parse_axis(const std::string& text);

/// Reads an axis of a sample: "path=a:b", "path=a:b:log" or "path=v,w,…". Throws InputError.
Axis parse_sampled_axis(const std::string& text);

/// Index of the listed value at a coordinate in [0, 1): each value has an equal share of the interval. Precondition:
/// the axis has listed values.
std::size_t place_at(const Axis& axis, double coordinate);

/// The value of a sampled axis at a coordinate in [0, 1): of a range the value at that fraction, of a list the value at
/// place_at().
std::string value_at(const Axis& axis, double coordinate);

/// The points of a sweep, numbered from 0: all combinations of the values of several axes, the last one fastest, or a
/// sample of them.
class SweepPoints {
 public:
  /// A grid. Throws InputError for two axes of one path and for more than kMostRuns combinations. Precondition: every
  /// axis has values.
  explicit SweepPoints(std::vector<Axis> axes);
  /// A sample of the box that the axes span. Throws InputError for two axes of one path and for too many axes.
  /// Precondition: every axis has a range or values.
  SweepPoints(std::vector<Axis> axes, const Sampling& sampling);

  std::size_t size() const { return size_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// None for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }
  /// Index of the value of an axis in a run. Precondition: Axis::size() > 0.
  std::size_t place(std::size_t run, std::size_t axis) const;
  /// The run of a grid that has a number when the axes are counted in another order, the last one fastest.
  /// Precondition: it is a grid, and `order` holds each axis once.
  std::size_t run(std::size_t number, const std::vector<std::size_t>& order) const;
  /// The value itself, computed anew at each call. Precondition, here and below: run < size().
  std::string value(std::size_t run, std::size_t axis) const;
  /// One value for each axis.
  std::vector<std::string> values(std::size_t run) const;
  /// The values as overrides "path=value", then what goes along with them.
  std::vector<std::string> overrides(std::size_t run) const;
  std::int64_t stride(std::size_t run) const;

 private:
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::optional<UnitSample> sample_;
  std::vector<std::size_t> strides_;  ///< of a grid: distance between runs with neighbouring values of an axis
  std::size_t size_ = 1;
};

}  // namespace hapbench
