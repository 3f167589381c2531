#include "scenarios/thesis/assumption_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/evidence.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns the value in a cell of an assumption's column. Throws InputError if the assumption does not allow this
/// value.
std::string allowed_value(const Assumption& assumption, std::string_view cell, const fs::path& file, std::size_t line) {
  const auto& range = assumption.range;
  const auto number = finite_number(cell);
  const bool is_allowed = range ? number && *number >= range->first && *number <= range->second
                                : std::ranges::find(assumption.options, cell) != assumption.options.end();
  if (is_allowed) return std::string(cell);
  const std::string allowed = range ? fmt::format("a number of the range {} ... {}", range->first, range->second)
                                    : quoted_list(assumption.options);
  fail_in_line(file, line, fmt::format("{}: got \"{}\"; allowed: {}", assumption.id, cell, allowed));
}

/// Runs a scenario and writes its results. Returns the reason why the results cannot be used; empty if they can be
/// used.
std::string problem_of_run(const Evidence& evidence, const std::string& name) {
  try {
    const CheckedScenario scene = checked(evidence.load(name));
    const Result run = run_scenario(scene, evidence.directory / name, false);
    // If a simulated subject loses the drill, the remaining targets are not removed. This is a result and not a
    // problem.
    const bool diverged = run.end.outcome == Outcome::diverges &&
                          !std::holds_alternative<TrackingHandFields>(scene.scenario().hand) &&
                          !outcome_is_expected(scene.scenario().expect, Outcome::diverges);
    return diverged ? name + ": diverged" : "";
  } catch (const InputError& error) {
    return error.what();
  }
}

/// Runs the scenario of a calibration. Returns the mean number of colliding points over the steps with contact, divided
/// by the published mean number.
double raw_ratio(const Assumptions& assumptions, const std::vector<std::string>& values, const Calibration& target) {
  Evidence evidence;
  evidence.overrides = [&](const Scenario& scenario) { return assumptions.overrides(scenario, values); };
  const Result run = evidence.run(
      target.scenario, {"record.trajectory=false", "record.ratio_iterations=[]", "record.ideal_trajectory=false"});
  const auto number = [&](const char* metric) { return number_of(run.metrics, metric).value_or(0.0); };
  return number("colliding_mean") / std::max(number("contact_share"), 1e-9) / target.raw;
}

/// Calibrates assumption number `index` in `values`. Returns false if its range has no value that gives the published
/// number of raw points.
bool calibrate(const Assumptions& assumptions, std::vector<std::string>& values, std::size_t index) {
  constexpr int kRuns = 8;
  const Assumption& assumption = assumptions.all()[index];
  // The number of raw points grows with the value of the input. These are bounds of the estimated slope of
  // log(number of raw points) over log(value).
  constexpr double kSmallestSlope = 0.3, kLargestSlope = 5.0;
  const double low = math::log(assumption.range->first), high = math::log(assumption.range->second);
  double at = math::log(finite_number(assumption.value).value()), slope = 1.0;
  std::optional<std::pair<double, double>> before;  // log(value) and log(raw_ratio()) of the previous run
  for (int run = 0; run < kRuns; ++run) {
    values[index] = run == 0 ? assumption.value : fmt::format("{:.6g}", math::exp(at));
    const double ratio = raw_ratio(assumptions, values, *assumption.calibration);
    if (std::abs(ratio - 1.0) <= kCalibrationTolerance) return true;
    const double excess = math::log(std::max(ratio, 1e-9));
    if (before && excess != before->second)
      slope = std::clamp((excess - before->second) / (at - before->first), kSmallestSlope, kLargestSlope);
    before = {at, excess};
    at = std::clamp(at - excess / slope, low, high);
    if (at == before->first) return false;  // the value stays at an end of the range
  }
  return false;
}

}  // namespace

std::vector<AssumptionSet> read_assumption_sets(const fs::path& file, const Assumptions& assumptions) {
  const std::string text = read_named_file(file);
  const std::vector<std::string> ids = names_of(assumptions.all(), &Assumption::id);
  CsvReader csv(LineReader(text), file, Words(ids.begin(), ids.end()));
  if (const auto note = csv.note_of_lines_above())
    fail_in_file(file, *note + "; allowed: comments, which begin with #");
  std::vector<std::size_t> assumption_of_column;  // index of the assumption of each column
  for (const std::string_view column : csv.columns()) {
    const std::string id(column);
    require_valid_name(file.string() + ": got the column", id, ids, "hapbench describe assumptions");
    const auto index = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
    if (std::ranges::find(assumption_of_column, index) != assumption_of_column.end())
      fail_in_line(file, csv.header_line(), fmt::format("got the column \"{}\" twice; allowed: each once", id));
    assumption_of_column.push_back(index);
  }
  std::vector<AssumptionSet> sets;
  while (csv.next()) {
    AssumptionSet& set = sets.emplace_back(AssumptionSet{assumptions.recorded_values()});
    for (std::size_t i = 0; i < assumption_of_column.size(); ++i) {
      const std::size_t index = assumption_of_column[i];
      set.values[index] = allowed_value(assumptions.all()[index], csv.cells()[i], file, csv.line());
      set.given.insert(index);
    }
  }
  if (sets.empty()) fail_in_file(file, "got no row; allowed: an assumption set in each");
  return sets;
}

std::string difference_text(const AssumptionSet& set, const Assumptions& assumptions) {
  std::string text;
  for (std::size_t i = 0; i < assumptions.all().size(); ++i) {
    const Assumption& assumption = assumptions.all()[i];
    if (set.values[i] != assumption.value)
      append_item(text, fmt::format("{} = {}", assumption.id, set.values[i]), ", ");
  }
  return text.empty() ? "as recorded" : text;
}

CalibratedSet calibrated(AssumptionSet set, const Assumptions& assumptions) {
  CalibratedSet result{std::move(set)};
  const std::vector<Assumption>& all = assumptions.all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].calibration || result.set.given.contains(i)) continue;
    const std::vector<std::string> scenario = {all[i].calibration->scenario};
    // Check whether another assumption of the set changes the scenario of the calibration.
    bool changes = false;
    for (std::size_t other = 0; other < all.size(); ++other)
      changes = changes || (other != i && !all[other].fields.empty() && all[other].reaches(scenario, "") &&
                            result.set.values[other] != all[other].value);
    if (changes && !calibrate(assumptions, result.set.values, i)) result.missed.insert(i);
  }
  return result;
}

std::vector<SetFinding> judge_set(const JudgingInputs& inputs, const CalibratedSet& calibrated,
                                  const std::vector<Claim>& claims, const fs::path& directory) {
  const std::vector<std::string>& values = calibrated.set.values;
  // Remove the results at the end of this scope.
  const std::shared_ptr<void> results(nullptr, [&directory](void*) {
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  });
  std::set<std::string> used;
  // For each scenario that was run: the reason why its results cannot be used; empty if they can be used.
  std::map<std::string, std::string> problems;
  Evidence evidence{inputs.assumptions.with_numbers(inputs.published, values),
                    directory,
                    {},
                    {},
                    [&used](const std::string& scenario) { used.insert(scenario); }};
  evidence.overrides = [&](const Scenario& scenario) { return inputs.assumptions.overrides(scenario, values); };
  // Run each scenario when its results are first needed.
  evidence.provide = [&](const std::string& scenario) {
    used.insert(scenario);
    const auto [found, is_new] = problems.try_emplace(scenario);
    if (is_new) found->second = problem_of_run(evidence, scenario);
    if (!found->second.empty()) throw InputError(found->second);
  };
  // Judge the claims.
  Measurements measurements;
  std::vector<SetFinding> findings;
  for (const Claim& claim : claims) {
    used.clear();
    SetFinding& judged = findings.emplace_back();
    try {
      const Finding finding = measurements.finding(claim, evidence);
      judged = {std::string(verdict_name(finding.verdict)), finding.number, finding.why, {}};
      if (finding.earlier) judged.earlier = verdict_name(*finding.earlier);
    } catch (const IoError&) {
      throw;  // an error such as a full disk says nothing about the claim
    } catch (const std::exception& error) {
      judged = {kNotMeasured, "", error.what(), {}};
      if (claim.earlier.judge != nullptr) judged.earlier = kNotMeasured;
    }
    judged.scenarios.assign(used.begin(), used.end());
    for (const std::size_t missed : calibrated.missed) {
      const Assumption& input = inputs.assumptions.all()[missed];
      if (!input.reaches(judged.scenarios, "")) continue;
      judged.verdict = verdict_name(Verdict::not_judged);
      judged.why =
          fmt::format("no value of {} gives the published {} raw points", input.id, plain(input.calibration->raw));
    }
  }
  return findings;
}

}  // namespace hapbench
