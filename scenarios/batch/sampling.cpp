#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

Sampling parse_sampling(const std::string& text, std::uint64_t seed) {
  const Words parts = parts_of(text, ':');
  const std::string_view name = parts[0];
  if (name == "sobol") {
    fail_in_option("--sample",
                   "\"sobol\" is no longer known; instead: lhs:N, or --points FILE.csv with the points of another "
                   "program");
  }
  const auto count = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  if ((name != kLatinHypercube && name != kRandomPoints) || !count || *count < 1 || *count > kMaxRuns) {
    fail_in_option("--sample", fmt::format("got \"{}\"; allowed: lhs:N or random:N with 1 <= N <= {}", text, kMaxRuns));
  }
  return {name == kLatinHypercube ? kLatinHypercube : kRandomPoints, *count, seed, {}};
}

std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis) {
  if (sampling.method == kPointsOfFile) return sampling.of_file[axis];
  // Largest double below 1: rounding could otherwise move a point of the last interval to 1.
  constexpr double kLast = 1.0 - 0x1.0p-53;
  Random random(Random::derive(sampling.seed, axis));
  std::vector<double> points(sampling.count);
  if (sampling.method == kRandomPoints) {
    for (double& point : points) point = random.uniform();
    return points;
  }
  // Latin hypercube: shuffle the intervals, and draw a point in each.
  std::vector<std::size_t> strata(sampling.count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] =
        std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(points.size()), kLast);
  return points;
}

Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes) {
  const std::string text = read_named_file(file);
  LineReader lines(text);
  for (const std::string& path : csv_cells(lines.next().value_or(""))) axes.push_back({path});
  Sampling sampling{kPointsOfFile, 0, 0, std::vector<std::vector<double>>(axes.size())};
  std::vector<std::map<std::string, std::size_t>> value_indices(axes.size());
  // Collect the distinct values of each field. In this loop a coordinate holds the index of its value.
  while (const auto line = lines.next()) {
    const std::vector<std::string> cells = csv_cells(*line);
    if (cells.size() != axes.size() || sampling.count == kMaxRuns) {
      fail_in_line(file, lines.line(),
                   fmt::format("got {} values in row {}; allowed: {}, one of each field, in at most {} rows",
                               cells.size(), sampling.count + 1, axes.size(), kMaxRuns));
    }
    ++sampling.count;
    try {
      for (std::size_t a = 0; a < cells.size(); ++a) {
        const std::string value = axis_value(cells[a]);
        const auto [at, is_new] = value_indices[a].emplace(value, value_indices[a].size());
        if (is_new) axes[a].values.push_back(value);
        sampling.of_file[a].push_back(static_cast<double>(at->second));
      }
    } catch (const InputError& error) {
      fail_in_line(file, lines.line(), error.problem());
    }
  }
  if (sampling.count == 0) fail_in_file(file, "has no rows; allowed: a header of fields, and rows of their values");
  // Replace each index by a coordinate: the middle of the part of [0, 1) that belongs to the value (Axis::index_at).
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (double& coordinate : sampling.of_file[a])
      coordinate = (coordinate + 0.5) / static_cast<double>(axes[a].size());
  return sampling;
}

}  // namespace hapbench
