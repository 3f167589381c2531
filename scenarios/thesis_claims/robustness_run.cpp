#include "scenarios/thesis_claims/robustness_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>

#include "results/io/json_text.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Verdicts = std::vector<std::string>;

std::string header(const RobustnessPlan& plan) {
  std::vector<std::string> columns = {"sample"};
  for (const OpenChoice& choice : plan.choices.all()) columns.push_back(choice.id);
  for (const Claim& claim : plan.claims) columns.emplace_back(claim.id);
  return fmt::format("{}", fmt::join(columns, ","));
}

/// The source and the build that compute the verdicts; empty when the commit does not tell the source.
std::string program_identity() {
  const Provenance p = provenance();
  if (p.commit == "unknown" || p.commit.ends_with("-dirty")) return "";
  return fmt::format("{} {} {} {}", p.commit, p.compiler, p.build_type, p.flags);
}

/// Names all that the verdicts depend on.
std::string definition(const RobustnessPlan& plan) {
  Json content = {{"table", header(plan)},
                  {"choices", plan.choices.hash()},
                  {"samples", plan.samples()},
                  {"program", program_identity()}};
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const LoadedScenario loaded = load_scenario(bundled.file);
    content["scenarios"].push_back(scenario_hash(loaded.scenario, loaded.files));
  }
  return fmt::format("robustness {}", hash_text(hash_of(json_text(content))));
}

/// The sample and the verdicts in a row; none when it is not of this plan.
std::optional<std::pair<std::size_t, Verdicts>> read_row(const RobustnessPlan& plan, const std::string& row) {
  const Words cells = parts_of(row, ',');
  const auto sample = whole_number(cells.front());
  const std::size_t leading = 1 + plan.choices.all().size();
  if (!sample || *sample >= plan.samples() || cells.size() != leading + plan.claims.size()) return std::nullopt;
  const Verdicts verdicts(cells.begin() + static_cast<std::ptrdiff_t>(leading), cells.end());
  if (robustness_row(plan, *sample, verdicts) != row) return std::nullopt;
  return std::pair{*sample, verdicts};
}

/// Puts what the journal holds into the report and returns the samples that are left.
std::vector<std::size_t> samples_to_do(const RobustnessPlan& plan, const fs::path& journal,
                                       const std::vector<std::string>& rows, RobustnessReport& report) {
  std::vector<bool> done(plan.samples());
  for (const std::string& row : rows) {
    auto read = read_row(plan, row);
    if (!read) fail_in_file(journal, fmt::format("got the row \"{}\"; allowed: rows of this plan", row.substr(0, 60)));
    done[read->first] = true;
    report.verdicts[read->first] = std::move(read->second);
  }
  std::vector<std::size_t> left;
  for (std::size_t sample = 0; sample < plan.samples(); ++sample) {
    if (!done[sample]) left.push_back(sample);
  }
  report.resumed = report.done = plan.samples() - left.size();
  return left;
}

}  // namespace

RobustnessReport run_robustness(const RobustnessPlan& plan, const RobustnessOptions& options) {
  const fs::path file = options.directory / "robustness.journal", scratch = options.directory / "robustness";
  const std::string title = definition(plan);
  // What a program without an identity computed is computed again.
  const bool resume = !options.anew && !program_identity().empty() && Journal::is_of(file, title);
  std::vector<std::string> rows;
  Journal journal(file, title, resume, [&rows](Journal::Place, std::string_view row) { rows.emplace_back(row); });
  RobustnessReport report;
  report.verdicts.resize(plan.samples());
  const std::vector<std::size_t> left = samples_to_do(plan, file, rows, report);
  fs::remove_all(scratch);  // of a process that was killed
  ProgressBar bar("robustness", plan.samples(), options.progress);
  bar.start_at(report.resumed);
  std::map<std::size_t, std::vector<std::string>> problems;
  const auto judge = [&](std::size_t sample) -> Delivery {
    return [&, sample, judged = judge_sample(plan, sample, scratch / std::to_string(sample))] {
      journal.add(robustness_row(plan, sample, judged.verdicts));
      journal.flush();
      report.verdicts[sample] = judged.verdicts;
      problems[sample] = judged.problems;
      bar.show(++report.done, true);
    };
  };
  const auto work = [&](std::size_t sample) -> Delivery {
    try {
      return judge(sample);
    } catch (const Stopped&) {
      return {};  // the same command judges it
    }
  };
  parallel_for(left, options.jobs, work, [] { return StopSignal::received() != 0; });
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  for (const auto& [sample, texts] : problems)
    report.problems.insert(report.problems.end(), texts.begin(), texts.end());
  if (report.done < plan.samples()) report.signal = StopSignal::received();
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
