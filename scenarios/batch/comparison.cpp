#include "scenarios/batch/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "algorithms/registry.hpp"
#include "scenarios/batch/seed_axis.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/relation_warnings.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// Largest seed: larger integers are not exact in a double.
constexpr std::int64_t kMaxSeed = std::int64_t{1} << 53;

/// Throws InputError if the seeds exceed the limit or the starting position cannot be displaced.
void check_seeds_and_jitter(const ComparisonQuestion& question, const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  const std::int64_t max_seed = kMaxSeed - static_cast<std::int64_t>(question.seeds - 1);
  if (scenario.seed > max_seed) {
    throw InputError(fmt::format("{}: /seed: got {}; allowed: at most {} with {} seeds", loaded.file.string(),
                                 scenario.seed, max_seed, question.seeds));
  }
  if (question.jitter == 0.0) return;
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) {
    fail_in(
        {.about_options = {"--jitter"}},
        fmt::format("{}: /motion/position/type: got \"file\", a recorded path, which --jitter cannot shift; allowed "
                    "with it: \"free\" or \"prescribed\"",
                    loaded.file.string()));
  }
  if (scenario.reference_force && std::holds_alternative<GivenForceFields>(*scenario.reference_force)) {
    fail_in(
        {.about_options = {"--jitter"}},
        fmt::format("{}: /reference_force: gives the forces of the path as it is, and --jitter would shift the path; "
                    "allowed with it: a reference_force of type \"rigid_contact\"",
                    loaded.file.string()));
  }
}

/// Returns the cases of a scene and appends its warnings. Of the warnings about unused fields (kNoEffect), it appends
/// only warnings that all algorithms have: a field that at least one algorithm reads has an effect in the
/// comparison.
Cases cases_of(const ComparisonQuestion& question, const fs::path& file, std::vector<std::string>& warnings) {
  const ScenarioText text = read_scenario_text(file);
  std::vector<Axis> axes = {{"rendering.algorithm", question.algorithms}};
  const Cases alone({text}, question.overrides, axes);
  // Check the named files only once, because they do not depend on the algorithm.
  const CheckedScenario checked_first = checked(alone.load(0));
  const LoadedScenario& first = checked_first.loaded();
  check_seeds_and_jitter(question, first);
  if (question.seeds > 1 || question.jitter != 0.0)
    axes.push_back(seed_axis(first.scenario, question.seeds, question.jitter));
  // Keep a warning about an unused field (kNoEffect) only if it occurs with every algorithm. Keep all warnings of other
  // kinds.
  std::vector<Warning> common = first.warnings, special;
  const auto is_special = [](const Warning& w) { return w.kind != kNoEffect; };
  std::ranges::copy_if(first.warnings, std::back_inserter(special), is_special);
  for (std::size_t a = 1; a < alone.size(); ++a) {
    const std::vector<Warning> others = alone.load(a).warnings;
    std::erase_if(common, [&](const Warning& w) { return std::ranges::find(others, w) == others.end(); });
    std::ranges::copy_if(others, std::back_inserter(special), is_special);
  }
  append_new(warnings, with_files(first, checked_first.file_warnings()));
  append_new(warnings, with_files(first, common));
  append_new(warnings, with_files(first, special));
  return {{text}, question.overrides, std::move(axes)};
}

}  // namespace

fs::path Comparison::folder(std::size_t run) const {
  const fs::path folder = scene_folder(scene(run)) / algorithm(run);
  return seeds > 1 ? folder / fmt::format("seed_{}", run % seeds) : folder;
}

std::vector<fs::path> Comparison::scene_folders(const fs::path& out) const {
  std::vector<fs::path> folders;
  for (std::size_t scene = 0; scene < scenes.size(); ++scene) folders.push_back(out / scene_folder(scene));
  return folders;
}

std::vector<fs::path> Comparison::run_folders(const fs::path& out) const {
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (const fs::path& scene : scene_folders(out)) {
    for (const std::string& law : algorithm_names()) {
      for (const auto& entry : fs::directory_iterator(scene / law, ignored))
        if (entry.path().filename().string().starts_with("seed_")) folders.push_back(entry.path());
      folders.push_back(scene / law);
    }
  }
  return folders;
}

Comparison planned(const ComparisonQuestion& question) {
  const auto names = names_of_scenarios(question.scenarios);
  Comparison comparison{{}, names, question.algorithms, question.seeds, {}, question.length};
  const std::size_t scenes = question.scenarios.size(), size = scenes * comparison.each();
  if (size > kMaxRuns) {
    throw InputError(fmt::format("got {} scenarios x {} algorithms x {} seeds = {} runs; allowed: at most {}", scenes,
                                 question.algorithms.size(), question.seeds, size, kMaxRuns));
  }
  for (const fs::path& file : question.scenarios)
    comparison.scenes.push_back(cases_of(question, file, comparison.warnings));
  return comparison;
}

void remove_earlier_comparison(const fs::path& folder, const Comparison& comparison) {
  std::error_code ignored;
  for (const char* table : {"ranking.csv", "comparison_timing.csv"}) fs::remove(folder / table, ignored);
  for (const fs::path& scene : comparison.scene_folders(folder)) fs::remove(scene / "comparison.csv", ignored);
  for (const fs::path& run : comparison.run_folders(folder)) {
    if (!fs::is_directory(run, ignored)) continue;
    remove_run(run);
    fs::remove(run, ignored);  // fails if the folder is not empty
  }
}

}  // namespace hapbench
