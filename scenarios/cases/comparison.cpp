#include "scenarios/cases/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/result_folder.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Largest seed of a scenario.
constexpr std::int64_t kMostSeed = std::int64_t{1} << 53;
/// Random stream of the start's shift, which keeps it independent of everything else that the scenario's seed
/// determines.
constexpr std::uint64_t kJitterStream = 0x6a697474;

bool lies_in_the_plane(const Environment& environment) {
  if (std::holds_alternative<Hole2d>(environment)) return true;
  const auto* springs = std::get_if<SpringsEnvironment>(&environment);
  if (springs == nullptr || (springs->random.count > 0 && !springs->random.planar)) return false;
  return std::all_of(springs->groups.begin(), springs->groups.end(),
                     [](const SpringGroup& group) { return group.direction.z() == 0.0; });
}

Vec3 start_shift(const Scenario& scenario, double length) {
  Random random(Random::derive(kJitterStream, static_cast<std::uint64_t>(scenario.seed)));
  return length * (lies_in_the_plane(scenario.environment) ? random.direction_in_plane() : random.direction());
}

void check_seeds_and_jitter(const ComparisonQuestion& question, const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  const std::int64_t most = kMostSeed - static_cast<std::int64_t>(question.seeds - 1);
  if (scenario.seed > most) {
    throw InputError(fmt::format("{}: /seed: got {}; allowed: at most {} with {} seeds", loaded.file.string(),
                                 scenario.seed, most, question.seeds));
  }
  if (question.jitter != 0.0 && !position_is_free(scenario.motion)) {
    throw InputError(fmt::format(
        "{}: /motion/position: prescribes the tool's place, which --jitter cannot shift; allowed with it: \"free\"",
        loaded.file.string()));
  }
}

/// The cases of a scene; adds its warnings, of those about its fields what all algorithms have: what only one of them
/// reads has an effect here.
Cases cases_of(const ComparisonQuestion& question, const fs::path& file, std::vector<std::string>& warnings) {
  const ScenarioText text = read_scenario_text(file);
  std::vector<Axis> axes = {{"rendering.algorithm", question.algorithms}};
  const Cases alone({text}, question.overrides, axes);
  const LoadedScenario first = checked(alone.load(0));  // the files are those of the scenario, whatever the algorithm
  check_seeds_and_jitter(question, first);
  if (question.seeds > 1 || question.jitter != 0.0)
    axes.push_back(seed_axis(first.scenario, question.seeds, question.jitter));
  std::vector<Warning> common = first.warnings;
  for (std::size_t a = 1; a < alone.size(); ++a) {
    const std::vector<Warning> of_this = alone.load(a).warnings;
    std::erase_if(common, [&](const Warning& w) { return std::ranges::find(of_this, w) == of_this.end(); });
  }
  append_new(warnings, with_files(first, first.file_warnings));
  append_new(warnings, with_files(first, common));
  return {{text}, question.overrides, std::move(axes)};
}

/// Returns true if a path stays below the directory when all links but its last part are followed.
bool lies_below(const fs::path& directory, const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  std::error_code error;
  const fs::path root = fs::canonical(directory, error);
  if (error) return false;
  const fs::path parent = fs::weakly_canonical(root / path.parent_path(), error);
  if (error || path.filename() == ".." || path.filename() == "." || path.filename().empty()) return false;
  return std::mismatch(root.begin(), root.end(), parent.begin(), parent.end()).first == root.end() &&
         !fs::is_symlink(fs::symlink_status(root / path, error));
}

/// The paths that a command listed under a name, without those that lead elsewhere; none where the list cannot be read.
std::vector<fs::path> listed(const fs::path& directory, const char* name) {
  std::vector<fs::path> paths;
  try {
    const Json list = parse_json(read_text_file(directory / kResultListFile, kLargestJsonFile)).at(name);
    if (!list.is_array()) return {};
    for (const Json& path : list)
      if (path.is_string() && lies_below(directory, path.get<std::string>()))
        paths.emplace_back(path.get<std::string>());
  } catch (const std::exception&) {
    paths.clear();
  }
  return paths;
}

Json texts_of(const std::vector<fs::path>& paths) {
  Json texts = Json::array();
  for (const fs::path& path : paths) texts.push_back(path.generic_string());
  return texts;
}

/// Removes the empty directories from `path` up to, but not including, `directory`.
void remove_empty(const fs::path& directory, fs::path path) {
  std::error_code error;
  for (; !path.empty(); path = path.parent_path())
    if (!fs::is_directory(directory / path, error) || !fs::remove(directory / path, error) || error) return;
}

}  // namespace

Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter) {
  Axis axis{"seed"};
  Scenario own = scenario;
  for (std::size_t k = 0; k < seeds; ++k, ++own.seed) {
    axis.values.push_back(std::to_string(own.seed));
    if (jitter == 0.0) continue;
    const Vec3 start = own.initial.position + start_shift(own, jitter);
    axis.along.push_back({{fmt::format("initial.position_m=[{},{},{}]", start.x(), start.y(), start.z())}});
  }
  return axis;
}

fs::path Comparison::scene_folder(std::size_t scene) const {
  return scenes.size() > 1 ? fs::path(names[scene]) : fs::path();
}

fs::path Comparison::folder(std::size_t run) const {
  const fs::path folder = scene_folder(scene(run)) / algorithm(run);
  return seeds > 1 ? folder / fmt::format("seed_{}", run % seeds) : folder;
}

Comparison planned(const ComparisonQuestion& question) {
  const auto names = names_of_scenarios(question.scenarios);
  Comparison comparison{{}, names, question.algorithms, question.seeds};
  const std::size_t scenes = question.scenarios.size(), size = scenes * comparison.each();
  if (size > kMostRuns) {
    throw InputError(fmt::format("got {} scenarios x {} algorithms x {} seeds = {} runs; allowed: at most {}", scenes,
                                 question.algorithms.size(), question.seeds, size, kMostRuns));
  }
  for (const fs::path& file : question.scenarios)
    comparison.scenes.push_back(cases_of(question, file, comparison.warnings));
  return comparison;
}

std::vector<Result> run_all(std::span<const Cases> all, const JobOptions& jobs,
                            const std::function<fs::path(std::size_t)>& folder) {
  struct Place {
    const Cases& cases;
    std::size_t i, run;
  };
  std::vector<Place> order;
  for (const Cases& cases : all) {
    const std::size_t first = order.size();
    for (std::size_t place = 0; place < cases.size(); ++place)
      order.push_back({cases, cases.at(place), first + cases.at(place)});
  }
  std::vector<Result> reports(order.size());
  for_each_job(order.size(), jobs, [&](std::size_t place) {
    const auto& [cases, i, run] = order[place];
    reports[run] = run_scenario(checked(cases.load(i)), folder ? std::optional(folder(run)) : std::nullopt, false);
    reports[run].targets.clear();
  });
  return reports;
}

void replace_earlier_results(const fs::path& directory, const ResultList& now) {
  for (const fs::path& run : listed(directory, "runs")) {
    if (std::ranges::find(now.runs, run) != now.runs.end()) continue;
    remove_run(directory / run);
    remove_empty(directory, run);
  }
  std::error_code ignored;
  for (const fs::path& table : listed(directory, "tables"))
    if (fs::remove(directory / table, ignored)) remove_empty(directory, table.parent_path());
  write_file_atomically(directory / kResultListFile,
                        json_text({{"runs", texts_of(now.runs)}, {"tables", texts_of(now.tables)}}));
}

void forget_results_if_none(const fs::path& directory) {
  std::error_code ignored;
  for (const char* name : {"runs", "tables"}) {
    for (const fs::path& path : listed(directory, name))
      if (fs::exists(directory / path, ignored) && !fs::is_empty(directory / path, ignored)) return;
  }
  fs::remove(directory / kResultListFile, ignored);
}

}  // namespace hapbench
