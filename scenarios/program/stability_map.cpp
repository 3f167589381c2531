#include "scenarios/studies/stability/stability_map.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

#include <algorithm>
#include <array>
#include <cmath>

#include "results/io/table_writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/stability.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::vector<const StabilityMap*> chosen_maps(const StabilityOptions& options) {
  const std::vector<std::string> names = names_of(stability_maps(), &StabilityMap::name);
  std::vector<const StabilityMap*> maps;
  for (const std::string& name : chosen_names("--map: got", options.maps, names)) {
    maps.push_back(find_stability_map(name));
    require_overridable(*maps.back(), options.overrides);
  }
  return maps;
}

std::vector<const IntegratorEntry*> chosen_integrators(const StabilityOptions& options) {
  if (options.integrators.empty()) return {MapSubject{}.integrator};
  std::vector<const IntegratorEntry*> integrators;
  for (const std::string& name : chosen_names("--integrators: got", options.integrators, all_integrators())) {
    integrators.push_back(find_integrator(name));
  }
  return integrators;
}

/// Every algorithm with every integrator, those of one algorithm side by side.
std::vector<MapSubject> chosen_subjects(const StabilityOptions& options) {
  std::vector<MapSubject> subjects;
  for (const std::string& algorithm : options.chosen_algorithms()) {
    for (const IntegratorEntry* integrator : chosen_integrators(options))
      subjects.push_back({algorithm, integrator, options.overrides});
  }
  return subjects;
}

std::string label(const MapSubject& subject) {
  return subject.integrator == MapSubject{}.integrator
             ? subject.algorithm
             : fmt::format("{} {}", subject.algorithm, subject.integrator->info.name);
}

/// The overrides of a subject on one line, as --set takes them.
std::string overrides_text(const MapSubject& subject) {
  std::vector<std::string> texts;
  for (const std::string& override : subject.overrides) {
    const std::size_t value = override.find('=') + 1;
    const std::string text = override.substr(value);
    texts.push_back(override.substr(0, value) + (Json::accept(text) ? parse_json(text).dump() : text));
  }
  return one_line(fmt::format("{}", fmt::join(texts, " ")));
}

void write_points(const fs::path& directory, const StabilityMap& map, const std::vector<MapResult>& results) {
  CsvWriter csv(directory / fmt::format("stability_map_{}.csv", map.name),
                map_header(kStabilityMapColumns, map.x.name, map.y.name));
  for (const MapResult& result : results) {
    const std::string overrides = overrides_text(result.subject);
    for (const MapPoint& p : result.points) {
      csv.row(std::string_view(result.subject.algorithm), p.x, p.y, run_verdict_name(p.verdict), p.lambda, p.margin,
              std::string_view(result.subject.integrator->info.name),
              p.verdict_from_far ? run_verdict_name(*p.verdict_from_far) : std::string_view(),
              std::string_view(overrides));
    }
  }
  csv.finish();
}

void write_boundary(const fs::path& directory, const StabilityMap& map, const std::vector<MapResult>& results) {
  CsvWriter csv(directory / fmt::format("stability_boundary_{}.csv", map.name),
                map_header(stability_boundary_columns(), map.x.name, map.y.name));
  for (const MapResult& result : results) {
    const std::string overrides = overrides_text(result.subject);
    for (const BoundaryPoint& p : result.boundary) {
      csv.row(std::string_view(result.subject.algorithm), p.x, p.analytic, p.simulation, p.difference(),
              std::string_view(p.no_theory), std::string_view(result.subject.integrator->info.name), p.worst_hand,
              std::span<const std::optional<double>>(p.limits), p.tangent, std::string_view(overrides));
    }
  }
  csv.finish();
}

/// The largest |relative difference| of a boundary; none without theory.
std::optional<double> largest_difference(const MapResult& result) {
  std::optional<double> largest;
  for (const BoundaryPoint& p : result.boundary) {
    if (const auto d = p.difference()) largest = std::max(largest.value_or(0.0), std::abs(*d));
  }
  return largest;
}

std::size_t count_of(const MapResult& result, RunVerdict verdict) {
  return static_cast<std::size_t>(std::count_if(result.points.begin(), result.points.end(),
                                                [verdict](const MapPoint& p) { return p.verdict == verdict; }));
}

/// The classes of motion, which tables always show, then those of runs that did not stay at the surface, if any.
std::vector<RunVerdict> shown_verdicts(std::span<const MapResult> results) {
  std::vector<RunVerdict> shown;
  for (const RunVerdict verdict : kRunVerdicts) {
    const auto has = [verdict](const MapResult& result) { return count_of(result, verdict) > 0; };
    if (verdict <= RunVerdict::diverged || std::any_of(results.begin(), results.end(), has)) shown.push_back(verdict);
  }
  return shown;
}

/// Draws the classes of the runs, or of the runs from far. '=' marks the analytic limit: the first diverged run beyond
/// it, 'o' a run that did not stay at the surface.
std::string drawn_classes(const MapResult& result, bool from_far) {
  constexpr std::string_view kMarks = ".:~#o";  // in the order of the enumeration
  const std::size_t n = result.size;
  const MapAxis &x = result.map->x, &y = result.map->y;
  const auto cell = [&](std::size_t column, std::size_t row) {
    const MapPoint& point = result.points[column * n + row];
    const RunVerdict verdict = from_far ? point.verdict_from_far.value() : point.verdict;
    const auto beyond = [&](std::size_t j) { return y.at(j, n) > result.boundary[column].theory().value_or(1e300); };
    const bool limit = verdict == RunVerdict::diverged && beyond(row) && (row == 0 || !beyond(row - 1));
    return limit ? '=' : kMarks[std::min(static_cast<std::size_t>(verdict), kMarks.size() - 1)];
  };
  std::vector<std::string> labels(n);
  for (const std::size_t row : {std::size_t{0}, n - 1}) labels[row] = significant(y.at(row, n), 3);
  return character_map({x.name, n, significant(x.low, 3), significant(x.high, 3)}, y.name, labels, cell);
}

std::string drawing(const MapResult& result) {
  const std::string overrides = overrides_text(result.subject);
  std::string text = fmt::format("{}: {}{}\n\n{}", label(result.subject), result.map->summary,
                                 overrides.empty() ? "" : "\nbut " + overrides, drawn_classes(result, false));
  if (result.map->far)
    text += fmt::format("\nfrom {} times as far:\n\n{}", *result.map->far, drawn_classes(result, true));
  text += "  . stable  : dying out  ~ vibrating  # diverged  = diverged, first beyond the analytic limit";
  const auto left = [](const MapPoint& p) { return p.verdict > RunVerdict::diverged; };
  return text + (std::any_of(result.points.begin(), result.points.end(), left) ? "  o left the surface\n\n" : "\n\n");
}

/// More drawings are too many to read; those of a single algorithm are all drawn.
constexpr std::size_t kMostDrawn = 4;

bool are_alike(const MapResult& a, const MapResult& b) {
  const auto same_motion = [](const MapPoint& p, const MapPoint& q) {
    return p.verdict == q.verdict && p.verdict_from_far == q.verdict_from_far;
  };
  const auto same_edge = [](const BoundaryPoint& p, const BoundaryPoint& q) { return p.simulation == q.simulation; };
  return std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), same_motion) &&
         std::equal(a.boundary.begin(), a.boundary.end(), b.boundary.begin(), b.boundary.end(), same_edge);
}

/// The drawings of one map; where all are the same, the first one and a remark.
std::string drawings_of(const std::vector<MapResult>& results, bool draw) {
  const MapResult& first = results.front();
  const bool alike =
      std::all_of(results.begin(), results.end(), [&](const MapResult& r) { return are_alike(r, first); });
  std::string text;
  if (results.size() > 1 && alike) {
    if (draw) text = drawing(first);
    return text + fmt::format("{}: the same map and edge in all {} rows below\n\n", first.map->name, results.size());
  }
  if (!draw) return "";
  for (const MapResult& result : results) text += drawing(result);
  return text;
}

Json result_json(const MapResult& result) {
  Json rows = Json::array();
  for (const BoundaryPoint& p : result.boundary) {
    Json limits = Json::object();
    for (std::size_t i = 0; i < p.limits.size(); ++i) limits[stiffness_limits()[i].name] = or_null(p.limits[i]);
    rows.push_back(
        {{result.map->x.name, p.x},
         {"analytic", or_null(p.analytic)},
         {"simulation", p.simulation},
         {"simulation_tolerance", or_null(if_any(std::isfinite(p.simulation), kMapPrecision * p.simulation))},
         {"relative_difference", or_null(p.difference())},
         {"no_theory", p.no_theory},
         {"worst_hand", or_null(p.worst_hand)},
         {"tangent", or_null(p.tangent)},
         {"limits", std::move(limits)}});
  }
  Json json = {{"map", result.map->name},
               {"algorithm", result.subject.algorithm},
               {"integrator", result.subject.integrator->info.name},
               {"overrides", result.subject.overrides},
               {"boundary", std::move(rows)}};
  for (const RunVerdict verdict : shown_verdicts({&result, 1}))
    json[std::string(run_verdict_name(verdict))] = count_of(result, verdict);
  return json;
}

std::vector<std::string> cells_of(const MapResult& result, const std::vector<RunVerdict>& shown) {
  const auto difference = largest_difference(result);
  const auto without =
      std::count_if(result.boundary.begin(), result.boundary.end(), [](const BoundaryPoint& p) { return !p.analytic; });
  std::vector<std::string> cells = {result.map->name, result.subject.algorithm, result.subject.integrator->info.name};
  for (const RunVerdict verdict : shown) cells.push_back(std::to_string(count_of(result, verdict)));
  cells.push_back(difference ? deserved_difference(100.0 * *difference, 100.0 * kMapPrecision) : "-");
  cells.push_back(std::to_string(without));
  return cells;
}

std::vector<Table::Column> headings_of(std::span<const RunVerdict> shown) {
  std::vector<Table::Column> headings = {
      {"map", false, "a map of stability --map; \"hapbench describe stability\" has all of them"},
      {"algorithm", false},
      {"integrator", false}};
  for (const RunVerdict verdict : shown) {
    const std::string name(run_verdict_name(verdict));
    headings.push_back({name, true, name});
    std::replace(headings.back().title.begin(), headings.back().title.end(), '_', ' ');
  }
  headings.push_back({"off theory %"});
  headings.push_back(
      {"no theory", true, "number of places along x at which there is no limit in theory; no_theory says why"});
  return headings;
}

}  // namespace

std::vector<Table::Column> map_headings() {
  return headings_of(kRunVerdicts);
}

int stability_maps_command(const StabilityOptions& options) {
  const std::vector<const StabilityMap*> maps = chosen_maps(options);
  const std::vector<MapSubject> subjects = chosen_subjects(options);
  const fs::path out = results_directory(options.out, "stability_maps");
  require_writable_directory(out);

  const bool draw = options.chosen_algorithms().size() == 1 || maps.size() * subjects.size() <= kMostDrawn;
  std::string drawings;
  std::set<std::string> without_theory;
  Json json = Json::array();
  std::vector<MapResult> all;
  for (const StabilityMap* map : maps) {
    std::vector<MapResult> results;
    for (const MapSubject& subject : subjects) {
      const JobOptions jobs = options.job_options(fmt::format("{} {}", map->name, label(subject)));
      results.push_back(stability_map(*map, subject, options.size, jobs));
      json.push_back(result_json(results.back()));
      for (const BoundaryPoint& p : results.back().boundary)
        if (!p.no_theory.empty()) without_theory.insert(fmt::format("no theory in {}: {}", map->name, p.no_theory));
    }
    drawings += drawings_of(results, draw);
    write_points(out, *map, results);
    write_boundary(out, *map, results);
    all.insert(all.end(), results.begin(), results.end());
  }
  const std::vector<RunVerdict> shown = shown_verdicts(all);
  Table table(headings_of(shown));
  for (const MapResult& result : all) table.add(cells_of(result, shown));
  if (!draw)
    drawings += fmt::format("more than {} maps are not drawn; --algorithms NAME draws those of one\n\n", kMostDrawn);
  std::string remarks;
  for (const std::string& remark : without_theory) remarks += wrapped(remark, 0);
  if (std::any_of(maps.begin(), maps.end(),
                  [](const StabilityMap* map) { return map->name == std::string_view("z_width"); }))
    remarks += "which K to quote: device_model/README.md, \"Which K to quote?\"\n";
  print(options.output, drawings + table.text() + remarks + fmt::format("\nmaps in {}\n", out.string()), json);
  return kSuccess;
}

}  // namespace hapbench
