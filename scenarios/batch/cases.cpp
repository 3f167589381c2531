#include "scenarios/batch/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// By the method's number.
constexpr std::string_view kMethodNames[] = {"lhs", "random", "points"};

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

/// How slowly an axis varies in the order of runs, the slowest first: what a shell depends on before all else.
int speed(const Axis& axis) {
  if (axis.path == kSceneAxis) return 0;
  return axis.path == "environment" || axis.path.starts_with("environment.") ? 1 : 2;
}

std::vector<std::size_t> run_order(const std::vector<Axis>& axes) {
  std::vector<std::size_t> order(axes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&axes](std::size_t a) { return speed(axes[a]); });
  return order;
}

}  // namespace

void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more) {
  for (const std::string& text : more)
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
}

std::string_view sampling_name(SamplingMethod method) {
  return kMethodNames[static_cast<std::size_t>(method)];
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
  if (sampling.method == SamplingMethod::latin_hypercube) return latin_hypercube(random, sampling.count);
  std::vector<double> points(sampling.count);
  for (double& point : points) point = random.uniform();
  return points;
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

Shard parse_shard(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = whole_number(std::string_view(text).substr(0, slash));
  const auto count = whole_number(std::string_view(text).substr(std::min(slash + 1, text.size())));
  if (!index || !count || *index >= *count || *count > kMostRuns) {
    throw InputError(
        fmt::format("--shard: got \"{}\"; allowed: i/n with 0 <= i < n <= {}, as in 0/4", text, kMostRuns));
  }
  return {*index, *count};
}

std::string shard_text(const Shard& shard) {
  return fmt::format("{}/{}", shard.index, shard.count);
}

Cases::Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
             std::optional<Sampling> sampling)
    : scenes_(std::move(scenes)),
      sets_(std::move(sets)),
      axes_(std::move(axes)),
      sampling_(sampling),
      order_(run_order(axes_)) {
  check_paths();
  if (sampling_) {
    size_ = sampling_->count;
    for (std::size_t a = 0; a < axes_.size(); ++a) unit_.push_back(unit_sample(*sampling_, a));
    sort_sample();
    return;
  }
  double size = 1.0;  // a double, because the product may overflow integers
  for (const Axis& axis : axes_) size *= static_cast<double>(axis.size());
  if (size > static_cast<double>(kMostRuns))
    throw InputError(fmt::format("--vary: got a grid of {:.7g} runs; allowed: at most {}", size, kMostRuns));
  strides_.resize(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0; size_ *= axes_[a].size()) strides_[a] = size_;
}

Cases::Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, PointTable points)
    : scenes_(std::move(scenes)),
      sets_(std::move(sets)),
      axes_(std::move(points.axes)),
      sampling_(Sampling{SamplingMethod::points, points.places[0].size()}),
      places_(std::move(points.places)),
      order_(run_order(axes_)),
      size_(sampling_->count) {
  check_paths();
  sort_sample();
}

void Cases::check_paths() const {
  std::set<std::string> paths;
  for (const Axis& axis : axes_) {
    if (paths.insert(axis.path).second) continue;
    throw InputError(fmt::format("--vary: got \"{}\" twice; allowed: each field once", axis.path));
  }
}

/// Each point of a sampled range has a value of its own, which no other case shares.
void Cases::sort_sample() {
  std::vector<std::size_t> slow;
  for (const std::size_t a : order_)
    if (speed(axes_[a]) < 2 && axes_[a].size() > 0) slow.push_back(a);
  if (slow.empty()) return;
  sorted_.resize(size_);
  std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
  std::ranges::stable_sort(sorted_, [&](std::size_t i, std::size_t j) {
    const auto differs = std::ranges::find_if(slow, [&](std::size_t a) { return place(i, a) != place(j, a); });
    return differs != slow.end() && place(i, *differs) < place(j, *differs);
  });
}

std::size_t Cases::place(std::size_t i, std::size_t axis) const {
  if (!sampling_) return i / strides_[axis] % axes_[axis].size();
  return places_.empty() ? axes_[axis].place_at(unit_[axis][i]) : places_[axis][i];
}

std::string Cases::value(std::size_t i, std::size_t axis) const {
  return unit_.empty() ? axes_[axis].value(place(i, axis)) : axes_[axis].value_at(unit_[axis][i]);
}

std::vector<std::string> Cases::values(std::size_t i) const {
  std::vector<std::string> values(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) values[a] = value(i, a);
  return values;
}

std::vector<std::string> Cases::changes(std::size_t i) const {
  std::vector<std::string> changes = values(i);
  for (std::size_t a = 0; a < axes_.size(); ++a) changes[a].insert(0, axes_[a].path + "=");
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (axes_[a].along.empty()) continue;
    const std::vector<std::string>& more = axes_[a].along[place(i, a)].overrides;
    changes.insert(changes.end(), more.begin(), more.end());
  }
  return changes;
}

const ScenarioText& Cases::scene(std::size_t i) const {
  const auto axis = std::ranges::find(axes_, kSceneAxis, &Axis::path);
  return scenes_[axis == axes_.end() ? 0 : place(i, static_cast<std::size_t>(axis - axes_.begin()))];
}

std::vector<std::string> Cases::overrides(std::size_t i) const {
  std::vector<std::string> overrides = sets_;
  for (std::string& change : changes(i))
    if (overridden_path(change) != kSceneAxis) overrides.push_back(std::move(change));
  return overrides;
}

LoadedScenario Cases::load(std::size_t i) const {
  LoadedScenario loaded = load_scenario(scene(i), overrides(i));
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (!axes_[a].along.empty()) loaded.scenario.time.stride *= axes_[a].along[place(i, a)].stride;
  return loaded;
}

std::size_t Cases::at(std::size_t place) const {
  if (sampling_) return sorted_.empty() ? place : sorted_[place];
  std::size_t i = 0;
  for (std::size_t k = order_.size(); k-- > 0; place /= axes_[order_[k]].size())
    i += place % axes_[order_[k]].size() * strides_[order_[k]];
  return i;
}

}  // namespace hapbench
