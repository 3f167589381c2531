#include "scenarios/thesis/robustness.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/evidence.hpp"
#include "scenarios/thesis/sensitivity.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns a cell of a choice's column. Throws InputError if the choice does not allow its value.
std::string allowed_value(const OpenChoice& choice, std::string_view cell, const fs::path& file, std::size_t line) {
  const auto& range = choice.range;
  const auto number = finite_number(cell);
  const bool is_allowed = range ? number && *number >= range->first && *number <= range->second
                                : std::ranges::find(choice.options, cell) != choice.options.end();
  if (is_allowed) return std::string(cell);
  const std::string allowed =
      range ? fmt::format("a number of the range {} ... {}", range->first, range->second) : quoted_list(choice.options);
  fail_in_line(file, line, fmt::format("{}: got \"{}\"; allowed: {}", choice.id, cell, allowed));
}

/// Runs a scenario and writes its results. Returns why the results cannot be used; empty if they can.
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

/// Returns for each choice the bin of each reading in `which`, for the sensitivity analysis.
std::vector<std::vector<std::size_t>> bins_of_choices(const Readings& readings, const std::vector<std::size_t>& which) {
  // Use at most 16 bins. Each bin has at least 16 readings if there are enough readings.
  const std::size_t count = std::clamp<std::size_t>(which.size() / 16, 2, 16);
  std::vector<std::vector<std::size_t>> bins;
  for (std::size_t c = 0; c < readings.choices.all().size(); ++c) {
    const OpenChoice& choice = readings.choices.all()[c];
    std::vector<double> values;
    std::vector<std::size_t> indices;
    for (const std::size_t reading : which) {
      const std::string& value = readings.values[reading][c];
      const auto option = std::find(choice.options.begin(), choice.options.end(), value);
      indices.push_back(static_cast<std::size_t>(option - choice.options.begin()));
      values.push_back(finite_number(value).value_or(0.0));
    }
    bins.push_back(choice.range ? equal_count_bins(values, count) : indices);
  }
  return bins;
}

/// Returns the entry of claim number `c` in robustness.json.
Json entry_of(const Readings& readings, const std::vector<ReadingVerdicts>& judged, std::size_t c) {
  const JudgedClaim& claim = readings.claims[c];
  const std::string on_record(verdict_name(claim.finding.verdict));
  // Count the verdicts over the readings.
  std::map<std::string, std::size_t> counts;
  std::vector<std::size_t> with_verdict;
  std::vector<double> holds;
  std::size_t not_measured = 0, same = 0, reproduced = 0;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const std::string& verdict = judged[i].verdicts[c];
    not_measured += verdict == kNotMeasured ? 1U : 0U;
    if (verdict == kNotMeasured || verdict == kNotJudged) continue;
    same += verdict == on_record ? 1U : 0U;
    reproduced += verdict == verdict_name(Verdict::reproduced) ? 1U : 0U;
    ++counts[verdict];
    with_verdict.push_back(i);
    holds.push_back(verdict == on_record ? 1.0 : 0.0);
  }
  // Most frequent verdict; the recorded verdict wins a tie.
  std::string majority = on_record;
  for (std::size_t most = same; const auto& [verdict, count] : counts) {
    if (count > most) majority = verdict;
    most = std::max(most, count);
  }
  // Find the choice that decides whether the recorded verdict holds.
  Json decided_by = nullptr;
  if (const auto by = deciding_input(bins_of_choices(readings, with_verdict), holds, hash_of(claim.claim.id)))
    decided_by = {{"choice", readings.choices.all()[by->input].id}, {"index", by->index}};
  return {{"id", claim.claim.id},
          {"choices", claim.reach},
          {"on_record", on_record},
          {"majority", majority},
          {"judged", with_verdict.size()},
          {"holds", same},
          {"reproduced", reproduced},
          {"not_measured", not_measured},
          {"verdicts", counts},
          {"decided_by", std::move(decided_by)}};
}

}  // namespace

std::vector<std::vector<std::string>> read_readings(const fs::path& file, const Choices& choices) {
  const std::string text = read_named_file(file);
  const std::vector<std::string> ids = names_of(choices.all(), &OpenChoice::id);
  CsvReader csv(LineReader(text), file, Words(ids.begin(), ids.end()));
  std::vector<std::size_t> choice_of_column;  // index of the choice of each column
  for (const std::string_view column : csv.columns()) {
    const std::string id(column);
    require_valid_name(file.string() + ": got the column", id, ids, "scripts/readings.py 1");
    const auto index = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
    if (std::find(choice_of_column.begin(), choice_of_column.end(), index) != choice_of_column.end())
      fail_in_file(file, fmt::format("got the column \"{}\" twice; allowed: each once", id));
    choice_of_column.push_back(index);
  }
  std::vector<std::vector<std::string>> readings;
  while (csv.next()) {
    std::vector<std::string>& values = readings.emplace_back(choices.values_on_record());
    for (std::size_t i = 0; i < choice_of_column.size(); ++i)
      values[choice_of_column[i]] = allowed_value(choices.all()[choice_of_column[i]], csv.cells()[i], file, csv.line());
  }
  if (readings.empty()) fail_in_file(file, "got no row; allowed: a reading of the choices on record in each");
  return readings;
}

ReadingVerdicts judge_reading(const Readings& readings, std::size_t reading, const fs::path& directory) {
  const std::vector<std::string>& values = readings.values[reading];
  // Remove the results at the end of this scope.
  const std::shared_ptr<void> results(nullptr, [&directory](void*) {
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  });
  // Run each scenario when its results are first needed.
  std::map<std::string, std::string> problems;  // for each scenario that was run: why its results cannot be used;
                                                // empty if they can
  Evidence evidence{
      readings.choices.with_numbers(readings.published, values), directory, {}, [&](const Scenario& scenario) {
        return readings.choices.overrides(scenario, values);
      }};
  evidence.provide = [&](const std::string& scenario) {
    const auto [found, is_new] = problems.try_emplace(scenario);
    if (is_new) found->second = problem_of_run(evidence, scenario);
    if (!found->second.empty()) throw InputError(found->second);
  };
  // Judge the claims.
  ReadingVerdicts judged;
  for (const JudgedClaim& j : readings.claims) {
    if (j.claim.costly && reading >= readings.costly()) {
      judged.verdicts.emplace_back(kNotJudged);
      continue;
    }
    try {
      judged.verdicts.emplace_back(verdict_name(j.claim.finding(evidence).verdict));
    } catch (const IoError&) {
      throw;  // an error such as a full disk says nothing about the claim
    } catch (const std::exception& error) {
      judged.verdicts.emplace_back(kNotMeasured);
      judged.problems.push_back(fmt::format("sample {}, {}: {}", reading, j.claim.id, error.what()));
    }
  }
  return judged;
}

std::string robustness_table(const Readings& readings, const std::vector<ReadingVerdicts>& judged) {
  std::string text = "sample";
  for (const OpenChoice& choice : readings.choices.all()) text += "," + choice.id;
  for (const JudgedClaim& j : readings.claims) text += fmt::format(",{}", j.claim.id);
  for (std::size_t i = 0; i < judged.size(); ++i)
    text += fmt::format("\n{},{},{}", i, fmt::join(readings.values[i], ","), fmt::join(judged[i].verdicts, ","));
  return text + "\n";
}

Json robustness_json(const Readings& readings, const std::vector<ReadingVerdicts>& judged, const Json& before) {
  Json entries = Json::array();
  for (std::size_t c = 0; c < readings.claims.size(); ++c) entries.push_back(entry_of(readings, judged, c));
  for (const Json& old : before.value("claims", Json::array())) {
    const auto same = [&old](const JudgedClaim& j) { return old.at("id") == j.claim.id; };
    if (std::none_of(readings.claims.begin(), readings.claims.end(), same)) entries.push_back(old);
  }
  return {{"choices", readings.choices.hash()},
          {"samples", readings.values.size()},
          {"costly_samples", readings.costly()},
          {"claims", std::move(entries)}};
}

}  // namespace hapbench
