#include "scenarios/thesis_claims/robustness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "results/io/atomic_file.hpp"
#include "scenarios/batch/sampling.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis_claims/sensitivity.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A directory that does not outlive its owner.
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

/// Switches off the records that nobody reads.
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
  record.pose = record.pose && read({"trajectory.csv"});
  record.torque = record.torque && read({"trajectory.csv", "torque", "summary.json"});
  record.timing = false;
}

/// The results of one sample, run when they are asked for.
class SampleRuns {
 public:
  SampleRuns(const RobustnessPlan& plan, std::size_t sample, const fs::path& directory)
      : directory_(directory),
        read_(plan.read),
        evidence_{plan.published,
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
      const RunReport report =
          run_with_shell(loaded, make_shell(loaded.scenario, loaded.files), directory_ / name, false);
      const std::vector<Outcome>& expected = loaded.scenario.expect.outcomes;
      // A subject who loses the drill misses the targets that are left, which is a result.
      const bool diverged = report.summary.result.outcome == Outcome::diverges &&
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

/// For each input the bins of the samples given.
std::vector<std::vector<std::size_t>> bins_of_choices(const RobustnessPlan& plan,
                                                      const std::vector<std::size_t>& samples) {
  // Sixteen points in a bin for a mean, sixteen bins for a curve, where there are enough.
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
  RobustnessPlan plan{std::move(choices), std::move(published), std::move(claims), std::move(read), {}};
  const Sampling sampling{SamplingMethod::latin_hypercube, samples, kRobustnessSeed};
  const UnitSample sample(sampling, plan.choices.all().size());
  for (std::size_t i = 0; i < samples; ++i) plan.values.push_back(plan.choices.values_at(sample.point(i)));
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
      judged.verdicts.emplace_back(verdict_name(claim.judge(claim.measure(runs.evidence()), plan.published).verdict));
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

}  // namespace hapbench
