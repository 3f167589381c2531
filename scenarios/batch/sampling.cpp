#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

struct NamedMethod {
  std::string_view name;
  SamplingMethod method;
};
constexpr NamedMethod kMethods[] = {
    {"lhs", SamplingMethod::latin_hypercube}, {"random", SamplingMethod::random}, {"points", SamplingMethod::points}};

/// Largest coordinate, since rounding could move a point in the last stratum to 1.
constexpr double kLast = 1.0 - 0x1.0p-53;

std::vector<double> latin_hypercube(Random& random, std::size_t count) {
  std::vector<std::size_t> strata(count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  std::vector<double> points(count);
  for (std::size_t i = 0; i < count; ++i)
    points[i] = std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(count), kLast);
  return points;
}

std::vector<double> independent(Random& random, std::size_t count) {
  std::vector<double> points(count);
  for (double& point : points) point = random.uniform();
  return points;
}

}  // namespace

std::string_view sampling_name(SamplingMethod method) {
  return std::find_if(std::begin(kMethods), std::end(kMethods),
                      [method](const NamedMethod& m) { return m.method == method; })
      ->name;
}

Sampling parse_sampling(const std::string& text, std::uint64_t seed) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = std::string_view(text).substr(0, colon);
  if (name == "sobol") {
    throw InputError(
        "--sample: \"sobol\" is no longer known; instead: lhs:N, or --points FILE.csv with the points of another program");
  }
  const auto count = whole_number(std::string_view(text).substr(std::min(colon + 1, text.size())));
  if ((name != "lhs" && name != "random") || !count || *count < 1 || *count > kMostRuns) {
    throw InputError(
        fmt::format("--sample: got \"{}\"; allowed: lhs:N or random:N with 1 <= N <= {}", text, kMostRuns));
  }
  return {name == "lhs" ? SamplingMethod::latin_hypercube : SamplingMethod::random, *count, seed};
}

std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis) {
  Random random(Random::derive(sampling.seed, axis));
  return sampling.method == SamplingMethod::random ? independent(random, sampling.count)
                                                   : latin_hypercube(random, sampling.count);
}

PointTable read_points(const std::filesystem::path& file) {
  const std::string text = read_named_file(file);
  LineReader lines(text);
  PointTable table;
  for (const std::string& path : csv_cells(lines.next().value_or(""))) table.axes.push_back({path});
  table.places.resize(table.axes.size());
  std::vector<std::map<std::string, std::uint32_t>> known(table.axes.size());
  while (const auto line = lines.next()) {
    const std::vector<std::string> cells = csv_cells(*line);
    if (cells.size() != known.size() || table.places[0].size() == kMostRuns) {
      fail_in_line(file, lines.line(),
                   fmt::format("got {} values in row {}; allowed: {}, one of each field, in at most {} rows",
                               cells.size(), table.places[0].size() + 1, known.size(), kMostRuns));
    }
    try {
      for (std::size_t a = 0; a < cells.size(); ++a) {
        const std::string value = axis_value(cells[a]);
        const auto place = static_cast<std::uint32_t>(known[a].size());
        const auto [at, is_new] = known[a].emplace(value, place);
        if (is_new) table.axes[a].values.push_back(value);
        table.places[a].push_back(at->second);
      }
    } catch (const InputError& error) {
      fail_in_line(file, lines.line(), error.problem());
    }
  }
  if (table.places[0].empty()) fail_in_file(file, "has no rows; allowed: a header of fields, and rows of their values");
  return table;
}

}  // namespace hapbench
