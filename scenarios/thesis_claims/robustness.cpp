#include "scenarios/thesis_claims/robustness.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// None when no input has an index.
std::optional<DecidingInput> largest_index(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                           std::span<const double> y) {
  std::optional<DecidingInput> largest;
  for (std::size_t i = 0; i < bins_of_inputs.size(); ++i) {
    const double index = first_order_index(bins_of_inputs[i], y);
    if (!std::isnan(index) && (!largest || index > largest->index)) largest = DecidingInput{i, index};
  }
  return largest;
}

}  // namespace

std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [values](std::size_t a, std::size_t b) { return values[a] < values[b]; });
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

namespace {

namespace fs = std::filesystem;

/// Removes a directory at the end of its scope.
class ScratchDirectory {
 public:
  explicit ScratchDirectory(fs::path path) : path_(std::move(path)) {}
  ~ScratchDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

 private:
  fs::path path_;
};

/// Switches off the records that no claim reads.
void record_only(const std::set<std::string>& parts, RecordFields& record) {
  const auto read = [&parts](std::initializer_list<const char*> any_of) {
    return std::any_of(any_of.begin(), any_of.end(), [&parts](const char* part) { return parts.contains(part); });
  };
  record.trajectory = record.trajectory && read({"trajectory.csv"});
  record.contacts = record.contacts && read({"contacts.csv"});
  record.stiffness_tensor = record.stiffness_tensor && read({"stiffness_tensor.csv"});
  if (!read({"ratios.csv"})) record.ratio_iterations.clear();
  // The summary as a whole has sections of these.
  record.energy = record.energy && read({"energy.csv", "energy", "summary.json"});
  record.ideal_trajectory =
      record.ideal_trajectory && read({"ideal_trajectory.csv", "ideal_trajectory", "summary.json"});
  record.torque = record.torque && read({"trajectory.csv", "torque", "summary.json"});
  record.timing = false;
}

/// The results of one sample; scenarios run when a claim asks for their results.
class SampleRuns {
 public:
  SampleRuns(const RobustnessPlan& plan, std::size_t sample, const fs::path& directory)
      : directory_(directory),
        read_(plan.read),
        evidence_{plan.choices.with_numbers(plan.published, plan.values[sample]),
                  ResultFiles(directory, [this](const auto& scenario, const auto& part) { provide(scenario, part); }),
                  [&plan, sample](const Scenario& scenario) {
                    return plan.choices.overrides(scenario, plan.values[sample]);
                  }} {}
  SampleRuns(const SampleRuns&) = delete;
  SampleRuns& operator=(const SampleRuns&) = delete;

  const Evidence& evidence() const { return evidence_; }

 private:
  struct Run {
    bool complete = false;  ///< has everything the scenario records
    std::string problem;    ///< that ended it
  };

  void provide(const std::string& scenario, const std::string& part) {
    const auto read = read_.find(scenario);
    const bool foreseen = read != read_.end() && read->second.contains(part);
    auto found = runs_.find(scenario);
    if (found == runs_.end() || (!foreseen && !found->second.complete && found->second.problem.empty())) {
      found = runs_.insert_or_assign(scenario, run(scenario, foreseen ? &read->second : nullptr)).first;
    }
    if (!found->second.problem.empty()) throw InputError(found->second.problem);
  }

  Run run(const std::string& name, const std::set<std::string>* parts) {
    try {
      LoadedScenario loaded = evidence_.load(name);
      if (parts != nullptr) record_only(*parts, loaded.scenario.record);
      const Result report = run_with_shell(loaded, make_shell(loaded.scenario, loaded.files), directory_ / name, false);
      const std::vector<Outcome>& expected = loaded.scenario.expect.outcomes;
      // A subject who loses the drill misses the remaining targets, which is a result.
      const bool diverged = report.end.outcome == Outcome::diverges &&
                            !std::holds_alternative<TrackingHandFields>(loaded.scenario.hand) &&
                            std::find(expected.begin(), expected.end(), Outcome::diverges) == expected.end();
      return {parts == nullptr, diverged ? name + ": diverged" : ""};
    } catch (const InputError& error) {
      return {parts == nullptr, error.what()};
    }
  }

  fs::path directory_;
  const ResultsRead& read_;
  Evidence evidence_;
  std::map<std::string, Run> runs_;
};

/// The bins of these samples, for each choice.
std::vector<std::vector<std::size_t>> bins_of_choices(const RobustnessPlan& plan,
                                                      const std::vector<std::size_t>& samples) {
  // Sixteen bins with sixteen points each, if there are enough points.
  const std::size_t count = std::clamp<std::size_t>(samples.size() / 16, 2, 16);
  std::vector<std::vector<std::size_t>> bins;
  for (std::size_t c = 0; c < plan.choices.all().size(); ++c) {
    const auto& options = plan.choices.all()[c].options;
    std::vector<double> values;
    std::vector<std::size_t> indices;
    for (const std::size_t sample : samples) {
      const std::string& value = plan.values[sample][c];
      if (options) {
        indices.push_back(
            static_cast<std::size_t>(std::find(options->begin(), options->end(), value) - options->begin()));
      } else {
        values.push_back(finite_number(value).value_or(0.0));
      }
    }
    bins.push_back(options ? indices : equal_count_bins(values, count));
  }
  return bins;
}

std::optional<ClaimRobustness::DecidingChoice> deciding_choice(const RobustnessPlan& plan,
                                                               const std::vector<std::size_t>& samples,
                                                               const std::vector<double>& holds,
                                                               const std::string& id) {
  const auto deciding = deciding_input(bins_of_choices(plan, samples), holds, hash_of(id));
  if (!deciding) return std::nullopt;
  return ClaimRobustness::DecidingChoice{plan.choices.all()[deciding->input].id, deciding->index};
}

}  // namespace

RobustnessPlan plan_robustness(Choices choices, PublishedNumbers published, std::vector<Claim> claims, ResultsRead read,
                               std::size_t samples) {
  std::erase_if(claims, [](const Claim& claim) { return claim.timing; });
  const Sampling sampling{SamplingMethod::latin_hypercube, samples, kRobustnessSeed};
  Cases cases({}, {}, choices.axes(), sampling);
  RobustnessPlan plan{std::move(choices), std::move(published), std::move(claims),
                      std::move(read),    std::move(cases),     {}};
  for (std::size_t i = 0; i < samples; ++i) plan.values.push_back(plan.cases.values(i));
  return plan;
}

SampleVerdicts judge_sample(const RobustnessPlan& plan, std::size_t sample, const fs::path& directory) {
  const ScratchDirectory scratch(directory);
  const SampleRuns runs(plan, sample, directory);
  SampleVerdicts judged;
  for (const Claim& claim : plan.claims) {
    if (claim.costly && sample >= plan.costly_samples()) {
      judged.verdicts.emplace_back(kNotJudged);
      continue;
    }
    try {
      judged.verdicts.emplace_back(
          verdict_name(claim.judge(claim.measure(runs.evidence()), runs.evidence().published).verdict));
    } catch (const IoError&) {
      throw;  // a full disk says nothing about a claim
    } catch (const std::exception& error) {
      judged.verdicts.emplace_back(kNotMeasured);
      judged.problems.push_back(fmt::format("sample {}, {}: {}", sample, claim.id, error.what()));
    }
  }
  return judged;
}

std::vector<ClaimRobustness> robustness_of(const RobustnessPlan& plan, const std::vector<std::string>& on_record,
                                           const std::vector<std::vector<std::string>>& verdicts) {
  std::vector<ClaimRobustness> all;
  for (std::size_t c = 0; c < plan.claims.size(); ++c) {
    ClaimRobustness& claim = all.emplace_back();
    claim.id = plan.claims[c].id;
    claim.on_record = on_record[c];
    std::vector<std::size_t> samples;
    std::vector<double> holds;
    for (std::size_t sample = 0; sample < verdicts.size(); ++sample) {
      const std::string& verdict = verdicts[sample][c];
      if (verdict == kNotMeasured) ++claim.not_measured;
      if (verdict == kNotMeasured || verdict == kNotJudged) continue;
      ++claim.verdicts[verdict];
      samples.push_back(sample);
      holds.push_back(verdict == claim.on_record ? 1.0 : 0.0);
    }
    claim.judged = samples.size();
    claim.holds = static_cast<std::size_t>(std::count(holds.begin(), holds.end(), 1.0));
    const auto reproduced = claim.verdicts.find(std::string(verdict_name(Verdict::reproduced)));
    if (reproduced != claim.verdicts.end()) claim.reproduced = reproduced->second;
    if (claim.holds > 0 && claim.holds < claim.judged)
      claim.decided_by = deciding_choice(plan, samples, holds, claim.id);
  }
  return all;
}

namespace {

namespace fs = std::filesystem;
using Verdicts = std::vector<std::string>;

std::string header(const RobustnessPlan& plan) {
  std::vector<std::string> columns = {"sample"};
  for (const OpenChoice& choice : plan.choices.all()) columns.push_back(choice.id);
  for (const Claim& claim : plan.claims) columns.emplace_back(claim.id);
  return fmt::format("{}", fmt::join(columns, ","));
}

/// A text that identifies everything the verdicts depend on.
std::string definition(const RobustnessPlan& plan, const std::string& program) {
  Json content = {
      {"table", header(plan)}, {"choices", plan.choices.hash()}, {"samples", plan.samples()}, {"program", program}};
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const LoadedScenario loaded = load_scenario(bundled.file);
    content["scenarios"].push_back(scenario_hash(loaded.scenario, loaded.files));
  }
  return fmt::format("robustness {}", hash_text(hash_of(json_text(content))));
}

}  // namespace

RobustnessReport run_robustness(const RobustnessPlan& plan, const RobustnessOptions& options) {
  const fs::path file = options.directory / "robustness_samples.csv", scratch = options.directory / "robustness";
  const std::string name = definition(plan, options.program);
  // Results of a program without an identity cannot be trusted: compute them again.
  const bool resume = !options.anew && !options.program.empty() && TableFile::is_of(file, name);
  RobustnessReport report;
  report.verdicts.resize(plan.samples());
  const auto keep = [&](std::size_t sample, std::string_view row) {
    const std::size_t leading = 1 + plan.choices.all().size();
    const Words cells = parts_of(row, ',');
    if (cells.size() != leading + plan.claims.size())
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this plan", row.substr(0, 60)));
    report.verdicts[sample].assign(cells.begin() + static_cast<std::ptrdiff_t>(leading), cells.end());
    return true;
  };
  TableFile table({file, header(plan), {{"definition", name}}, plan.samples(), true},
                  resume ? TableFile::Keep(keep) : nullptr);
  report.resumed = table.count();
  fs::remove_all(scratch);  // of a process that was killed
  ProgressBar bar("robustness", plan.samples(), options.progress);
  bar.start_at(report.resumed);
  std::map<std::size_t, std::vector<std::string>> problems;
  for_each(plan.cases, {}, options.jobs, table, [&](std::size_t sample) -> TableRow {
    const SampleVerdicts judged = judge_sample(plan, sample, scratch / std::to_string(sample));
    return {robustness_row(plan, sample, judged.verdicts), [&, sample, judged] {
              report.verdicts[sample] = judged.verdicts;
              problems[sample] = judged.problems;
              bar.show(table.count(), true);
            }};
  });
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  for (const auto& [sample, texts] : problems)
    report.problems.insert(report.problems.end(), texts.begin(), texts.end());
  report.done = table.count();
  if (report.done < plan.samples())
    report.signal = StopSignal::received();
  else
    table.finish();
  return report;
}

std::string robustness_row(const RobustnessPlan& plan, std::size_t sample, const Verdicts& verdicts) {
  return fmt::format("{},{},{}", sample, fmt::join(plan.values[sample], ","), fmt::join(verdicts, ","));
}

std::string robustness_table(const RobustnessPlan& plan, const std::vector<Verdicts>& verdicts) {
  std::string text = header(plan) + "\n";
  for (std::size_t sample = 0; sample < plan.samples(); ++sample) {
    text += robustness_row(plan, sample, verdicts[sample]) + "\n";
  }
  return text;
}

}  // namespace hapbench
