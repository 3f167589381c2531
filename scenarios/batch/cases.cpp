#include "scenarios/batch/cases.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// Largest magnitude of a range's end: beyond the range of every field, and small enough that sums of weighted ends do
/// not overflow.
constexpr double kLargestEnd = 1e300;

[[noreturn]] void refuse_axis(const std::string& problem, const std::string& allowed) {
  throw InputError(problem + "; allowed: " + allowed);
}

/// The i-th of the values 0 ... last between two ends, which are returned exactly. Weighting the ends, rather than
/// adding steps, gives 0.3 and not 0.30000000000000004 for the third of ten steps from 0 to 1.
double linear_value(double a, double b, double i, double last) {
  if (i == 0.0 || i == last) return i == 0.0 ? a : b;
  return std::clamp((a * (last - i) + b * i) / last, std::min(a, b), std::max(a, b));
}

/// Reads "a:b", or "a:b:n" for a grid, optionally followed by ":log".
void read_range(std::string_view words, bool sampled, Axis& axis) {
  const Words parts = parts_of(words, ':');
  const std::size_t least = sampled ? 2 : 3;
  if (parts.size() != least && parts.size() != least + 1) {
    refuse_axis(fmt::format("got {} parts between colons", parts.size()),
                sampled ? "a:b or a:b:log" : "a:b:n or a:b:n:log; a:b and a:b:log with --sample");
  }
  const auto end = [](std::string_view word) {
    const auto number = finite_number(word);
    if (number && std::abs(*number) <= kLargestEnd) return *number;
    refuse_axis(fmt::format("got \"{}\" for an end of the range", word), "a finite number");
  };
  axis.range = {end(parts[0]), end(parts[1]), parts.size() > least};
  if (axis.range->logarithmic && parts.back() != "log")
    refuse_axis(fmt::format("got \"{}\"", parts.back()),
                sampled ? "\"log\" or nothing, as --sample says how many" : "\"log\" or nothing");
  const auto [from, to, logarithmic] = *axis.range;
  if (logarithmic && !(from > 0.0 && to > 0.0))
    refuse_axis(fmt::format("got ends {} and {} of a logarithmic range", from, to), "numbers > 0");
  if (sampled) return;
  axis.steps = whole_number(parts[2]).value_or(0);
  if (axis.steps < 2 || axis.steps > kMostRuns)
    refuse_axis(fmt::format("got \"{}\" values", parts[2]), fmt::format("an integer 2 ... {}", kMostRuns));
}

bool begins_json(std::string_view text) {
  return text.starts_with('{') || text.starts_with('[') || text.starts_with('"');
}

/// The parts between commas that stand outside of JSON.
std::vector<std::string> listed_words(std::string_view list) {
  std::vector<std::string> words;
  bool is_whole = true;
  for (const std::string_view part : parts_of(list, ',')) {
    if (is_whole)
      words.emplace_back(part);
    else
      words.back().append(",").append(part);
    is_whole = !begins_json(words.back()) || Json::accept(words.back());
  }
  if (words.size() > kMostRuns)
    refuse_axis(fmt::format("got {} values", words.size()), fmt::format("at most {}", kMostRuns));
  return words;
}

/// A value in the spelling that axes have. Throws InputError for text that begins as JSON and is none, and for no text.
std::string axis_value(std::string_view text) {
  if (text.empty()) throw InputError("got an empty value");
  if (const auto number = finite_number(text)) return cell_text(*number);
  return begins_json(text) ? parse_json(std::string(text)).dump() : std::string(text);
}

/// parse_axis without what is known of the field.
Axis read_axis(const std::string& text, bool sampled) {
  const std::size_t equals = text.find('=');
  Axis axis{text.substr(0, equals)};
  constexpr const char* kPathCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.$";
  if (equals == std::string::npos || axis.path.empty() ||
      axis.path.find_first_not_of(kPathCharacters) != std::string::npos) {
    refuse_axis("has no path", sampled ? "path=a:b, path=a:b:log or path=v,w, as in time.step_s=0.0001:0.001"
                                       : "path=a:b:n, path=a:b:n:log or path=v,w, as in time.step_s=0.0001:0.001:10");
  }
  const std::string_view values = std::string_view(text).substr(equals + 1);
  if (std::ranges::any_of(values, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    refuse_axis("has control characters", "numbers, names and JSON");
  if (!begins_json(values) && values.find(',') == values.npos && values.find(':') != values.npos) {
    read_range(values, sampled, axis);
    return axis;
  }
  for (const std::string& word : listed_words(values)) {
    try {
      axis.values.push_back(axis_value(word));
    } catch (const InputError& error) {
      refuse_axis(error.problem(), "numbers, names and JSON, separated by commas");
    }
  }
  return axis;
}

std::string range_text(const Axis& axis, double part, double whole) {
  const double value = axis.range->value_at(part, whole);
  return cell_text(axis.whole ? std::round(value) : value);
}

}  // namespace

double Range::value_at(double part, double whole) const {
  if (!logarithmic || part == 0.0 || part == whole) return linear_value(from, to, part, whole);
  // Decimal logarithms make decades exact.
  return std::clamp(math::pow(10.0, linear_value(math::log10(from), math::log10(to), part, whole)), std::min(from, to),
                    std::max(from, to));
}

Axis parse_axis(const std::string& text, bool sampled) {
  Axis axis;
  try {
    axis = read_axis(text, sampled);
  } catch (const InputError& error) {
    constexpr std::size_t kLongest = 200;
    const std::string shown = text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
    throw InputError(fmt::format("--vary \"{}\": {}", shown, error.problem()));
  }
  const std::vector<PlacedField> fields = placed_fields();
  const auto place = std::ranges::find(fields, axis.path, &PlacedField::path);
  if (place == fields.end()) return axis;
  const Json& schema = place->field->value.schema;
  axis.whole = axis.range && schema.value("type", Json()) == "integer";
  if (axis.values == std::vector<std::string>{"all"} && schema.contains("enum"))
    axis.values = schema["enum"].get<std::vector<std::string>>();
  return axis;
}

std::string Axis::value(std::size_t i) const {
  return range ? range_text(*this, static_cast<double>(i), static_cast<double>(steps - 1)) : values[i];
}

std::size_t Axis::place_at(double coordinate) const {
  const auto count = static_cast<double>(values.size());
  return std::min(static_cast<std::size_t>(coordinate * count), values.size() - 1);
}

std::string Axis::value_at(double coordinate) const {
  return range ? range_text(*this, coordinate, 1.0) : values[place_at(coordinate)];
}

void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more) {
  for (const std::string& text : more)
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
}

Sampling parse_sampling(const std::string& text, std::uint64_t seed) {
  const Words parts = parts_of(text, ':');
  const std::string_view name = parts[0];
  if (name == "sobol") {
    throw InputError(
        "--sample: \"sobol\" is no longer known; instead: lhs:N, or --points FILE.csv with the points of another program");
  }
  const auto count = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  if ((name != kLatinHypercube && name != kRandomPoints) || !count || *count < 1 || *count > kMostRuns) {
    throw InputError(
        fmt::format("--sample: got \"{}\"; allowed: lhs:N or random:N with 1 <= N <= {}", text, kMostRuns));
  }
  return {name == kLatinHypercube ? kLatinHypercube : kRandomPoints, *count, seed, {}};
}

std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis) {
  if (sampling.method == kPointsOfFile) return sampling.of_file[axis];
  constexpr double kLast = 1.0 - 0x1.0p-53;  // rounding could move a point in the last stratum to 1
  Random random(Random::derive(sampling.seed, axis));
  std::vector<double> points(sampling.count);
  if (sampling.method == kRandomPoints) {
    for (double& point : points) point = random.uniform();
    return points;
  }
  std::vector<std::size_t> strata(sampling.count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] =
        std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(points.size()), kLast);
  return points;
}

std::vector<std::string> csv_cells(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && in_quotes && line.substr(i + 1).starts_with('"')) {
      cells.back() += line[++i];
    } else if (line[i] == '"') {
      in_quotes = !in_quotes;
    } else if (line[i] == ',' && !in_quotes) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes) {
  const std::string text = read_named_file(file);
  LineReader lines(text);
  for (const std::string& path : csv_cells(lines.next().value_or(""))) axes.push_back({path});
  Sampling sampling{kPointsOfFile, 0, 0, std::vector<std::vector<double>>(axes.size())};
  std::vector<std::map<std::string, std::size_t>> known(axes.size());
  while (const auto line = lines.next()) {
    const std::vector<std::string> cells = csv_cells(*line);
    if (cells.size() != axes.size() || sampling.count == kMostRuns) {
      fail_in_line(file, lines.line(),
                   fmt::format("got {} values in row {}; allowed: {}, one of each field, in at most {} rows",
                               cells.size(), sampling.count + 1, axes.size(), kMostRuns));
    }
    ++sampling.count;
    try {
      for (std::size_t a = 0; a < cells.size(); ++a) {
        const std::string value = axis_value(cells[a]);
        const auto [at, is_new] = known[a].emplace(value, known[a].size());
        if (is_new) axes[a].values.push_back(value);
        sampling.of_file[a].push_back(static_cast<double>(at->second));
      }
    } catch (const InputError& error) {
      fail_in_line(file, lines.line(), error.problem());
    }
  }
  if (sampling.count == 0) fail_in_file(file, "has no rows; allowed: a header of fields, and rows of their values");
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (double& place : sampling.of_file[a]) place = (place + 0.5) / static_cast<double>(axes[a].size());
  return sampling;
}

Shard parse_shard(const std::string& text) {
  const Words parts = parts_of(text, '/');
  const auto index = whole_number(parts[0]), count = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  if (!index || !count || *index >= *count || *count > kMostRuns) {
    throw InputError(
        fmt::format("--shard: got \"{}\"; allowed: i/n with 0 <= i < n <= {}, as in 0/4", text, kMostRuns));
  }
  return {*index, *count};
}

Cases::Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
             std::optional<Sampling> sampling)
    : scenes_(std::move(scenes)), sets_(std::move(sets)), axes_(std::move(axes)), sampling_(std::move(sampling)) {
  std::set<std::string> paths;
  for (const Axis& axis : axes_)
    if (!paths.insert(axis.path).second)
      throw InputError(fmt::format("--vary: got \"{}\" twice; allowed: each field once", axis.path));
  strides_.resize(axes_.size());
  if (sampling_) {
    size_ = sampling_->count;
    for (std::size_t a = 0; a < axes_.size(); ++a) unit_.push_back(unit_sample(*sampling_, a));
    sampling_->of_file.clear();
  } else {
    double size = 1.0;  // a double, because the product may overflow integers
    for (const Axis& axis : axes_) size *= static_cast<double>(axis.size());
    if (size > static_cast<double>(kMostRuns))
      throw InputError(fmt::format("--vary: got a grid of {:.7g} runs; allowed: at most {}", size, kMostRuns));
    for (std::size_t a = axes_.size(); a-- > 0; size_ *= axes_[a].size()) strides_[a] = size_;
  }
  sort_runs();
}

/// Each point of a sampled range has a value of its own, which no other case shares.
void Cases::sort_runs() {
  std::vector<std::size_t> slow;  // what a shell depends on, the scene first
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const std::string& path = axes_[a].path;
    if (axes_[a].size() == 0) continue;
    if (path == kSceneAxis) slow.insert(slow.begin(), a);
    if (path == "environment" || path.starts_with("environment.")) slow.push_back(a);
  }
  if (slow.empty()) return;
  sorted_.resize(size_);
  std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
  std::ranges::stable_sort(sorted_, [&](std::size_t i, std::size_t j) {
    const auto differs = std::ranges::find_if(slow, [&](std::size_t a) { return place(i, a) != place(j, a); });
    return differs != slow.end() && place(i, *differs) < place(j, *differs);
  });
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
  const std::vector<std::string> all = changes(i);
  for (std::size_t c = 0; c < all.size(); ++c)
    if (c >= axes_.size() || !(axes_[c].named || axes_[c].path == kSceneAxis)) overrides.push_back(all[c]);
  return overrides;
}

LoadedScenario Cases::load(std::size_t i) const {
  LoadedScenario loaded = load_scenario(scene(i), overrides(i));
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (!axes_[a].along.empty()) loaded.scenario.time.stride *= axes_[a].along[place(i, a)].stride;
  return loaded;
}

std::size_t available_threads() {
  return static_cast<std::size_t>(tbb::info::default_concurrency());
}

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  ProgressBar bar(options.label, count);
  std::mutex mutex;  // of all below; unlocked only while a job runs
  std::size_t begun = 0, done = 0;
  std::map<std::size_t, std::exception_ptr> errors;  // by job
  const auto work = [&] {
    std::unique_lock lock(mutex);
    while (begun < count && errors.empty() && StopSignal::received() == 0) {
      const std::size_t i = begun++;
      std::exception_ptr caught;
      lock.unlock();
      try {
        job(i);
      } catch (...) {
        caught = std::current_exception();
      }
      lock.lock();
      if (caught)
        errors.emplace(i, caught);
      else
        bar.show(++done, true);
    }
  };
  const std::size_t threads = std::max(1u, options.threads);
  // A job may itself use TBB: that gets no more threads than there are jobs at once.
  const tbb::global_control within(tbb::global_control::max_allowed_parallelism,
                                   std::min(threads, available_threads()));
  std::unique_lock starting(mutex);  // no job begins before all threads are there
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < std::min(threads, count)) others.emplace_back(work);
  } catch (const std::exception& reason) {
    const std::string text = fmt::format("{}; if threads or memory ran short: fewer --jobs", reason.what());
    errors.emplace(0, std::make_exception_ptr(std::runtime_error(text)));
  }
  starting.unlock();
  work();
  others.clear();
  if (!errors.empty()) std::rethrow_exception(errors.begin()->second);
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
