#include "scenarios/program/guessed_spacing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/ranking_check.hpp"
#include "scenarios/program/ranking_text.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// The scene's own law first.
const std::vector<std::string> kLaws = {"shaped_stiffness", "mean", "proxy", "summation"};
constexpr const char* kOwnColumns[] = {"force_mean_in_contact_N", "inside_max_m"};

League league_at(double spacing, const Json& scene, const std::filesystem::path& directory) {
  BatchPlan plan;
  plan.definition.algorithms = kLaws;
  plan.definition.overrides = {fmt::format("environment.spacing_m={}", spacing)};
  plan.scenarios = {{.file = directory / "start.json", .json = scene}};
  plan.names = {"start"};
  const BatchReport report = run_batch(plan, {.directory = {}, .jobs = available_threads()});
  return make_league(league_runs(plan, report, compared_metrics()));
}

/// Why a spacing does not pass; empty when it does.
std::string fault_of(const std::vector<RankingColumn>& columns) {
  for (const RankingColumn& column : columns) {
    if (column.verdict.holding == Holding::flips) {
      return fmt::format("{} flips ({}, {})", column.metric, kLaws[column.verdict.law], kLaws[*column.verdict.other]);
    }
    if (std::ranges::find(kOwnColumns, column.metric) == std::end(kOwnColumns)) continue;
    const auto &before = column.before[0], &after = column.after[0];
    if (!before || !after || judged_column({{&*before, 1}}, {{&*after, 1}}, false).holding != Holding::holds)
      return fmt::format("{} of {} moves", column.metric, kLaws[0]);
  }
  return "";
}

}  // namespace

GuessedSpacing guessed_spacing(const Json& scene, const std::filesystem::path& directory, const SpacingTest& test) {
  constexpr double kMostTested = 250'000;  // points
  std::string fault;
  std::optional<League> before;
  for (const double parts : {5.0, 10.0, 20.0, 40.0}) {
    const double spacing = test.diameter / parts, half = 0.5 * spacing;
    const double points = static_cast<double>(test.points) * math::square(test.spacing / half);
    if (points > kMostTested) {
      fault += fault.empty() ? "half of it is beyond the test" : "; finer is beyond the test";
      break;
    }
    if (!before) before = league_at(spacing, scene, directory);
    League after = league_at(half, scene, directory);
    fault = fault_of(compared_columns(*before, after));
    if (fault.empty()) {
      return {spacing,
              fmt::format("{} apart: with half of that no order flips in the table of \"compare\", and mean force and "
                          "depth stay",
                          length_text(spacing))};
    }
    fault = fmt::format("at half of {} {}", length_text(spacing), fault);
    before = std::move(after);
  }
  return {test.spacing, fmt::format("{} apart; rankings may depend on it: {}", length_text(test.spacing), fault)};
}

}  // namespace hapbench
