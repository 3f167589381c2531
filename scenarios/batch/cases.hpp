#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// Appends the texts, such as warnings of cases, that are not in the list yet.
void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more);

/// The path of the axis whose values name scenes.
inline constexpr const char* kSceneAxis = "scenario";

/// How points are distributed over the unit cube.
enum class SamplingMethod {
  latin_hypercube,  ///< along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979)
  random,           ///< independent and uniform
  points            ///< as a file has them
};

/// The name of a method, as in --sample.
std::string_view sampling_name(SamplingMethod method);

/// A sample of the unit cube. Equal samples have the same points to the last bit on every machine.
struct Sampling {
  SamplingMethod method = SamplingMethod::latin_hypercube;
  std::size_t count = 1;   ///< points
  std::uint64_t seed = 1;  ///< of the shuffles, or the points themselves
};

/// Reads "lhs:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// The coordinates in [0, 1) of each point along an axis, from a stream of random numbers of its own: one more axis
/// does not change the others. Precondition: the points are not those of a file.
std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis);

/// The points of a file, a row each: the columns are the axes, whose values are listed once.
struct PointTable {
  std::vector<Axis> axes;
  std::vector<std::vector<std::uint32_t>> places;  ///< by axis: which of the axis's values a point has
};

/// Reads the table of --points: a header of fields' paths, and their values. Throws InputError with the line.
PointTable read_points(const std::filesystem::path& file);

/// A part of the cases: those whose place in the order of the runs leaves the remainder `index` when divided by
/// `count`. By default all.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  /// Number of the cases that belong to it.
  std::size_t size(std::size_t cases) const { return (cases + count - 1 - index) / count; }
};

/// Reads "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// "i/n"
std::string shard_text(const Shard& shard);

/// Scenes with overrides, of which fields vary: all combinations of the values of the axes, the last one fastest, or a
/// sample of them. Numbered from 0. Its size does not depend on their number, except for samples (8 bytes a case and
/// axis) and the rows of a file.
class Cases {
 public:
  /// A grid, or a sample of the box that the axes span. `scenes` has one, or one for each value of the axis kSceneAxis.
  /// `sets` are overrides of all cases, as in --set. Throws InputError for two axes of one path and for more than
  /// kMostRuns combinations. Precondition: on a grid every axis has values.
  Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
        std::optional<Sampling> sampling = {});
  /// The points of a file.
  Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, PointTable points);

  std::size_t size() const { return size_; }
  const std::vector<ScenarioText>& scenes() const { return scenes_; }
  const std::vector<std::string>& sets() const { return sets_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// None for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }

  // Precondition, here and below: i < size().

  /// Index of the value of an axis. Precondition: Axis::size() > 0.
  std::size_t place(std::size_t i, std::size_t axis) const;
  /// One value for each axis, computed anew at each call.
  std::vector<std::string> values(std::size_t i) const;
  /// The values as "path=value", then what goes along with them.
  std::vector<std::string> changes(std::size_t i) const;
  const ScenarioText& scene(std::size_t i) const;
  /// The overrides of the scene: the sets, and the changes but for the scene's own.
  std::vector<std::string> overrides(std::size_t i) const;
  /// The scenario. Thread-safe. Throws InputError.
  LoadedScenario load(std::size_t i) const;
  /// The case that runs at a place of the order of runs. Scenes, then fields of the environment vary slowest there, so
  /// that neighbours share a shell; apart from that cases are in order.
  std::size_t at(std::size_t place) const;

 private:
  void check_paths() const;
  void sort_sample();
  std::string value(std::size_t i, std::size_t axis) const;

  std::vector<ScenarioText> scenes_;
  std::vector<std::string> sets_;
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::vector<std::vector<double>> unit_;           ///< by axis: the coordinates of a random sample
  std::vector<std::vector<std::uint32_t>> places_;  ///< by axis: of the points of a file
  std::vector<std::size_t> strides_;  ///< of a grid: distance of cases with neighbouring values of an axis
  std::vector<std::size_t> order_;    ///< the axes, those that vary slowest first
  std::vector<std::size_t> sorted_;   ///< the order of a sample's runs; empty: as they are numbered
  std::size_t size_ = 1;
};

}  // namespace hapbench
