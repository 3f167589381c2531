#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

/// Cases: scenes with overrides, of which fields vary.
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

/// Appends the texts, such as warnings of cases, that are not in the list yet.
void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more);

/// The path of the axis whose values name scenes.
inline constexpr const char* kSceneAxis = "scenario";

// How points are distributed over the unit cube, as in --sample.
/// Along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979).
inline constexpr std::string_view kLatinHypercube = "lhs";
inline constexpr std::string_view kRandomPoints = "random";  ///< independent and uniform
inline constexpr std::string_view kPointsOfFile = "points";

/// A sample of the unit cube. Equal samples have the same points to the last bit on every machine.
struct Sampling {
  std::string_view method = kLatinHypercube;      ///< one of these names
  std::size_t count = 1;                          ///< points
  std::uint64_t seed = 1;                         ///< of the shuffles, or the points themselves
  std::vector<std::vector<double>> of_file = {};  ///< by axis: the coordinates of the points of a file
};

/// Reads "lhs:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// The coordinates in [0, 1) of each point along an axis, from a stream of random numbers of its own: one more axis
/// does not change the others.
std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis);

/// The cells of a line of a table, without their quotes and a carriage return at its end.
std::vector<std::string> csv_cells(std::string_view line);

/// Reads the table of --points: a header of fields' paths, which become axes that list each value once, and a row of
/// values for each point. Throws InputError with the line.
Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes);

/// The cases whose place in the order of the runs leaves the remainder `index` when divided by `count`; by default all.
struct Shard {
  std::size_t index = 0, count = 1;
};

/// Reads "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// "i/n"
inline std::string shard_text(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

/// Scenes with overrides, of which fields vary: all combinations of the values of the axes, the last one fastest, or a
/// sample of them. Numbered from 0. Memory: 8 bytes a case and axis of a sample, and 8 bytes a case where scenes or
/// fields of the environment vary.
class Cases {
 public:
  /// `scenes` has one, or one for each value of the axis kSceneAxis. `sets` are overrides of all cases, as in --set.
  /// Throws InputError for two axes of one path and for more than kMostRuns combinations. Precondition: without a
  /// sampling every axis has values.
  Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
        std::optional<Sampling> sampling = {});

  std::size_t size() const { return size_; }
  const std::vector<ScenarioText>& scenes() const { return scenes_; }
  const std::vector<std::string>& sets() const { return sets_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// None for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }

  // Precondition, here and below: i < size().

  /// Index of the value of an axis. Precondition: Axis::size() > 0.
  std::size_t place(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].place_at(unit_[axis][i]) : i / strides_[axis] % axes_[axis].size();
  }
  /// One value for each axis, computed anew at each call.
  std::vector<std::string> values(std::size_t i) const;
  /// The values as "path=value", then what goes along with them.
  std::vector<std::string> changes(std::size_t i) const;
  const ScenarioText& scene(std::size_t i) const;
  /// The overrides of the scene: the sets, and the changes but for names.
  std::vector<std::string> overrides(std::size_t i) const;
  /// The scenario. Thread-safe. Throws InputError.
  LoadedScenario load(std::size_t i) const;
  /// The case that runs at a place of the order of runs, in which scenes, then fields of the environment vary slowest,
  /// so that neighbours share a shell; apart from that cases are in order.
  std::size_t at(std::size_t place) const { return sorted_.empty() ? place : sorted_[place]; }

 private:
  void sort_runs();
  std::string value(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].value_at(unit_[axis][i]) : axes_[axis].value(place(i, axis));
  }

  std::vector<ScenarioText> scenes_;
  std::vector<std::string> sets_;
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::vector<std::vector<double>> unit_;  ///< by axis: the coordinates of a sample
  std::vector<std::size_t> strides_;       ///< of a grid: distance of cases with neighbouring values of an axis
  std::vector<std::size_t> sorted_;        ///< in the order of runs; empty: as they are numbered
  std::size_t size_ = 1;
};

/// Number of threads that this process may use at once.
std::size_t available_threads();

/// How for_each_job processes a list of jobs.
struct JobOptions {
  unsigned threads = 1;  ///< jobs at once; at least 1
  std::string label;     ///< text before the progress bar; empty for no bar
};

/// Calls job(0) … job(count - 1), each once, on several threads. Jobs begin in this order and at most `threads` of them
/// are under way; each writes to its own place, so that the result does not depend on the number of threads. After an
/// exception no further job starts, and that of the lowest job is rethrown; a signal (stop_signal.hpp) ends the loop
/// the same way. Throws std::runtime_error before any job begins when there are not so many threads to be had.
/// Overhead: some microseconds a job, some tens a thread.
void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job);

}  // namespace hapbench
