#include "scenarios/thesis/choices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "results/io/columns.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

OpenChoice choice_of(const Json& json) {
  const Json& value = json.at("value");
  OpenChoice choice{.id = json.at("id").get<std::string>(),
                    .value = value.is_number() ? cell_text(value.get<double>()) : value.get<std::string>(),
                    .options = json.value("options", std::vector<std::string>()),
                    .text = json_text(json)};
  if (json.contains("range")) choice.range = json.at("range").get<std::pair<double, double>>();
  for (const Json& field : json.value("fields", Json::array()))
    choice.fields.push_back({field.at("scenarios").get<std::vector<std::string>>(), field.at("path").get<std::string>(),
                             field.value("times", false)});
  return choice;
}

bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::ranges::any_of(field.scenarios, [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), scenario.c_str(), 0) == 0;
  });
}

using Place = std::pair<std::string, Json*>;  ///< a dotted path, and the value there

/// The places that a dotted path stands for. Throws InputError.
std::vector<Place> places_of(Json& scenario, const std::string& path) {
  std::vector<Place> places = {{"", &scenario}};
  for (const std::string_view key : parts_of(path, '.')) {
    std::vector<Place> below;
    for (const auto& [at, node] : places) {
      const bool every = key == "*" && node->is_array();
      bool found = every;
      for (auto& [name, value] : node->items()) {
        if (!every && name != key) continue;
        below.emplace_back(at.empty() ? name : at + "." + name, &value);
        found = true;
      }
      if (!found)
        throw InputError(fmt::format("{} has no {} \"{}\"", at.empty() ? "the scenario" : '"' + at + '"',
                                     node->is_array() ? "entry" : "field", key));
    }
    places = std::move(below);
  }
  return places;
}

/// The text of a choice's value at a place. Throws InputError.
std::string chosen_text(const Place& place, const ChosenField& field, const std::string& value) {
  if (!field.times) return value;
  if (!place.second->is_number())
    throw InputError(fmt::format("\"{}\" is no number, which a factor needs", place.first));
  return cell_text(finite_number(value).value_or(1.0) * place.second->get<double>());
}

// ---- Verdicts under other readings

/// None when no input has one.
std::optional<DecidingInput> largest_index(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                           std::span<const double> y) {
  std::optional<DecidingInput> largest;
  for (std::size_t i = 0; i < bins_of_inputs.size(); ++i) {
    const double index = first_order_index(bins_of_inputs[i], y);
    if (!std::isnan(index) && (!largest || index > largest->index)) largest = DecidingInput{i, index};
  }
  return largest;
}

/// A cell of a choice's column.
std::string checked(const OpenChoice& choice, std::string_view cell, const fs::path& file, std::size_t line) {
  const auto& range = choice.range;
  const auto number = finite_number(cell);
  const bool is_allowed = range ? number && *number >= range->first && *number <= range->second
                                : std::ranges::find(choice.options, cell) != choice.options.end();
  if (is_allowed) return std::string(cell);
  const std::string allowed =
      range ? fmt::format("a number of the range {} ... {}", range->first, range->second) : quoted_list(choice.options);
  fail_in_line(file, line, fmt::format("{}: got \"{}\"; allowed: {}", choice.id, cell, allowed));
}

/// Runs a scenario for its results. Says what keeps them from being judged by; empty for nothing.
std::string problem_of_run(const Evidence& evidence, const std::string& name) {
  try {
    const LoadedScenario loaded = evidence.load(name);
    const Result run = run_scenario(loaded, evidence.directory / name, false);
    // A subject who loses the drill misses the remaining targets, which is a result.
    const bool diverged = run.end.outcome == Outcome::diverges &&
                          !std::holds_alternative<TrackingHandFields>(loaded.scenario.hand) &&
                          !outcome_is_expected(loaded.scenario.expect, Outcome::diverges);
    return diverged ? name + ": diverged" : "";
  } catch (const InputError& error) {
    return error.what();
  }
}

/// The bins of these readings, for each choice.
std::vector<std::vector<std::size_t>> bins_of_choices(const Readings& readings, const std::vector<std::size_t>& which) {
  // Sixteen bins with sixteen points each, if there are enough points.
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

/// What the verdicts on the claim of this index say.
Json entry_of(const Readings& readings, const std::vector<ReadingVerdicts>& judged, std::size_t c) {
  const JudgedClaim& claim = readings.claims[c];
  const std::string on_record(verdict_name(claim.finding.verdict));
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
  // That of most readings; of several the one on record, if it is one of them.
  std::string majority = on_record;
  for (std::size_t most = same; const auto& [verdict, count] : counts) {
    if (count > most) majority = verdict;
    most = std::max(most, count);
  }
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

Choices::Choices(const fs::path& file) {
  std::string at = "/choices";
  try {
    const Json json = with_file(file, [&] { return read_json(file); });
    hash_ = hash_text(hash_of(json_text(json)));
    for (const Json& choice : json.at("choices")) {
      at = element("/choices", all_.size());
      all_.push_back(choice_of(choice));
    }
  } catch (const Json::exception& problem) {
    fail_in_file(file, fmt::format("{}: {}; allowed: what choices.schema.json says", at, problem.what()));
  }
}

std::vector<std::string> Choices::overrides(const Scenario& scenario, std::span<const std::string> values) const {
  Json changed = effective_scenario(scenario, scenario.directory);  // with every default, so that every field exists
  Json texts = Json::object();                                      // by path, in the order of their first change
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (const ChosenField& field : all_[i].fields) {
      if (!concerns(field, scenario.name)) continue;
      try {
        for (const Place& place : places_of(changed, field.path)) {
          const std::string text = chosen_text(place, field, values[i]);
          *place.second = Json::accept(text) ? parse_json(text) : Json(text);
          texts[place.first] = text;
        }
      } catch (const InputError& error) {
        throw InputError(fmt::format("choice \"{}\": in scenario {}, {}", all_[i].id, scenario.name, error.what()));
      }
    }
  }
  std::vector<std::string> overrides;
  for (const auto& [path, text] : texts.items()) overrides.push_back(path + "=" + text.get<std::string>());
  return overrides;
}

std::string Choices::reach(std::span<const std::string> scenarios, const std::string& rule) const {
  std::string reaching;
  for (const OpenChoice& choice : all_) {
    const std::string name = "<" + choice.id;
    const bool sets = std::ranges::any_of(choice.fields, [&](const ChosenField& field) {
      return std::ranges::any_of(scenarios, [&](const auto& scenario) { return concerns(field, scenario); });
    });
    const bool named = rule.find(name + ">") != std::string::npos || rule.find(name + ".mean") != std::string::npos;
    if (sets || (choice.fields.empty() && named)) reaching += choice.text;
  }
  return reaching.empty() ? "" : hash_text(hash_of(reaching));
}

std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [values](std::size_t i) { return values[i]; });
  std::vector<std::size_t> bin(values.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) bin[order[rank]] = rank * bins / order.size();
  return bin;
}

double first_order_index(std::span<const std::size_t> bin, std::span<const double> y) {
  if (y.empty()) return std::nan("");
  const auto n = static_cast<double>(y.size());
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
  std::vector<double> sums(*std::max_element(bin.begin(), bin.end()) + 1), counts(sums.size());
  double total = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    total += (y[i] - mean) * (y[i] - mean);
    sums[bin[i]] += y[i] - mean;
    counts[bin[i]] += 1.0;
  }
  double between = 0.0, filled = 0.0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    if (counts[b] == 0.0) continue;
    between += sums[b] * sums[b] / counts[b];
    filled += 1.0;
  }
  if (total == 0.0 || n <= filled) return std::nan("");
  return (between - (filled - 1.0) * (total - between) / (n - filled)) / total;
}

std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level,
                                            std::size_t permutations) {
  const std::optional<DecidingInput> found = largest_index(bins_of_inputs, y);
  if (!found) return std::nullopt;
  Random random(seed);
  std::size_t as_large = 0;
  for (std::size_t i = 0; i < permutations; ++i) {
    random.shuffle(y);
    as_large += largest_index(bins_of_inputs, y)->index >= found->index ? 1U : 0U;
  }
  // The order that was observed counts as one of them (Phipson and Smyth 2010).
  const double p = static_cast<double>(as_large + 1) / static_cast<double>(permutations + 1);
  return p <= level ? found : std::nullopt;
}

std::vector<std::vector<std::string>> read_readings(const fs::path& file, const Choices& choices) {
  const std::string text = read_named_file(file);
  CsvReader csv{LineReader(text), file};
  const std::vector<std::string> ids = names_of(choices.all(), &OpenChoice::id);
  std::vector<std::size_t> places;  // of the columns, among the choices
  for (const std::string_view column : csv.columns()) {
    const std::string id(column);
    require_valid_name(file.string() + ": got the column", id, ids, "scripts/readings.py 1");
    const auto place = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
    if (std::find(places.begin(), places.end(), place) != places.end())
      fail_in_file(file, fmt::format("got the column \"{}\" twice; allowed: each once", id));
    places.push_back(place);
  }
  std::vector<std::vector<std::string>> readings;
  while (csv.next()) {
    std::vector<std::string>& values = readings.emplace_back(choices.values_on_record());
    for (std::size_t i = 0; i < places.size(); ++i)
      values[places[i]] = checked(choices.all()[places[i]], csv.cells()[i], file, csv.line());
  }
  if (readings.empty()) fail_in_file(file, "got no row; allowed: a reading of the choices on record in each");
  return readings;
}

ReadingVerdicts judge_reading(const Readings& readings, std::size_t reading, const fs::path& directory) {
  const std::vector<std::string>& values = readings.values[reading];
  const std::shared_ptr<void> results(nullptr, [&directory](void*) {
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  });
  std::map<std::string, std::string> problems;  // by scenario; empty where its results are there
  Evidence evidence{
      readings.choices.with_numbers(readings.published, values), directory, {}, [&](const Scenario& scenario) {
        return readings.choices.overrides(scenario, values);
      }};
  evidence.provide = [&](const std::string& scenario) {
    const auto [found, is_new] = problems.try_emplace(scenario);
    if (is_new) found->second = problem_of_run(evidence, scenario);
    if (!found->second.empty()) throw InputError(found->second);
  };
  ReadingVerdicts judged;
  for (const JudgedClaim& j : readings.claims) {
    if (j.claim.costly && reading >= readings.costly()) {
      judged.verdicts.emplace_back(kNotJudged);
      continue;
    }
    try {
      judged.verdicts.emplace_back(verdict_name(j.claim.finding(evidence).verdict));
    } catch (const IoError&) {
      throw;  // a full disk says nothing about a claim
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
