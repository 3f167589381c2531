#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis_claims/claims.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
  std::vector<std::string> only;
  std::string out = (fs::path("results") / "out" / "reproduce").string();
  std::string ledger;
  bool no_cache = false;
  bool anew = false;
  std::size_t jobs = available_threads();
  OutputOptions output;
};

struct Judged {
  Claim claim;
  Finding finding;
};

std::vector<Claim> chosen_claims(const std::vector<std::string>& ids) {
  std::vector<Claim> claims = all_claims();
  if (ids.empty()) return claims;
  std::vector<std::string> valid;
  for (const Claim& claim : claims) valid.emplace_back(claim.id);
  for (const std::string& id : ids) require_valid_name("--only: got", id, valid);
  std::erase_if(claims, [&ids](const Claim& c) { return std::find(ids.begin(), ids.end(), c.id) == ids.end(); });
  return claims;
}

/// Returns true if the directory holds results of exactly this scenario, computed by exactly this program.
bool is_current(const fs::path& directory, const LoadedScenario& loaded) {
  try {
    const Json summary = parse_json(read_text_file(directory / "summary.json", kLargestJsonFile));
    const Json& made = summary.at("provenance");
    return made.at("scenario_hash") == scenario_hash(loaded.scenario, loaded.files) &&
           made.at("commit") == provenance().commit && !provenance().commit.ends_with("-dirty");
  } catch (const std::exception&) {
    return false;  // missing, damaged or of another version: run it
  }
}

/// Runs the thesis's scenarios into subdirectories, those apart whose results are current.
class ThesisRuns {
 public:
  ThesisRuns(const ReproduceOptions& options, const ShellCache& cache)
      : directory_(fs::path(options.out) / "thesis"), anew_(options.anew), cache_(cache) {
    for (const BundledScenario& bundled : bundled_scenarios()) {
      if (bundled.group == "thesis") scenarios_.push_back(bundled);
    }
  }

  const fs::path& directory() const { return directory_; }

  /// All of them, on several threads.
  void run_all(std::size_t jobs, bool progress) {
    std::vector<std::size_t> runs(scenarios_.size());
    std::iota(runs.begin(), runs.end(), std::size_t{0});
    ProgressBar bar("thesis", runs.size(), progress);
    std::size_t done = 0;
    const auto work = [&](std::size_t i) -> Delivery {
      std::vector<std::string> problems = run(scenarios_[i]);
      return [&, i, problems = std::move(problems)] {
        tell(scenarios_[i], problems);
        bar.show(++done, true);
      };
    };
    parallel_for(runs, jobs, work, [] { return false; });
  }

  /// One of them, unless that has been done.
  void provide(const std::string& name) {
    for (const BundledScenario& bundled : scenarios_) {
      if (bundled.name == name && !done_.contains(name)) tell(bundled, run(bundled));
    }
  }

  bool all_as_expected() const { return as_expected_; }

 private:
  std::vector<std::string> run(const BundledScenario& bundled) const {
    const LoadedScenario loaded = load_scenario(bundled.file);
    if (!anew_ && is_current(directory_ / bundled.name, loaded)) return {};
    return run_scenario(loaded, directory_ / bundled.name, false, cache_).unmet;
  }
  void tell(const BundledScenario& bundled, const std::vector<std::string>& problems) {
    done_.insert(bundled.name);
    as_expected_ = as_expected_ && problems.empty();
    for (const std::string& problem : problems) fmt::print(stderr, "hapbench: {}: {}\n", bundled.name, problem);
  }

  fs::path directory_;
  bool anew_;
  const ShellCache& cache_;
  std::vector<BundledScenario> scenarios_;
  std::set<std::string> done_;
  bool as_expected_ = true;
};

Json ledger_json(const std::vector<Judged>& judged, const PublishedNumbers& published) {
  Json claims = Json::array();
  for (const Judged& j : judged) {
    claims.push_back({{"id", j.claim.id},
                      {"place", j.claim.place},
                      {"claim", j.claim.claim},
                      {"published", j.claim.published},
                      {"measured", j.finding.measured},
                      {"rule", j.claim.rule(published)},
                      {"verdict", verdict_name(j.finding.verdict)},
                      {"why", j.finding.why},
                      {"timing", j.claim.timing}});
  }
  return {{"claims", std::move(claims)}};
}

std::string ledger_markdown(const std::vector<Judged>& judged) {
  std::string text = "| id | place | claim | published | measured | verdict | why |\n|---|---|---|---|---|---|---|\n";
  for (const Judged& j : judged) {
    text += fmt::format("| {} | {} | {} | {} | {} | **{}** | {} |\n", j.claim.id, j.claim.place, j.claim.claim,
                        j.claim.published, j.finding.measured, verdict_name(j.finding.verdict), j.finding.why);
  }
  return text;
}

int reproduce(const ReproduceOptions& options) {
  const std::vector<Claim> claims = chosen_claims(options.only);
  const PublishedNumbers published(HAPBENCH_PUBLISHED_DIR);
  require_writable_directory(options.out);
  const ShellCache cache = shell_cache(options.no_cache);
  ThesisRuns runs(options, cache);
  // Single claims run what they ask for.
  if (options.only.empty()) runs.run_all(options.jobs, !options.output.quiet);

  const Evidence evidence{
      published,
      ResultFiles(runs.directory(), [&runs](const std::string& name, const std::string&) { runs.provide(name); }),
      cache};
  std::vector<Judged> judged;
  Table table({{"id", false}, {"verdict", false}, {"measured", false}});
  for (const Claim& claim : claims) {
    judged.push_back({claim, claim.judge(claim.measure(evidence), published)});
    table.add({claim.id, std::string(verdict_name(judged.back().finding.verdict)), judged.back().finding.measured});
  }
  const Json json = ledger_json(judged, published);
  const fs::path ledger = options.ledger.empty() ? fs::path(options.out) / "claims.json" : fs::path(options.ledger);
  write_file_atomically(ledger, json_text(json));
  write_file_atomically(fs::path(ledger).replace_extension(".md"), ledger_markdown(judged));
  print(options.output, table.text() + fmt::format("\nledger in {}\n", ledger.string()), json);
  return runs.all_as_expected() ? kSuccess : kUnexpectedOutcome;
}

}  // namespace

void add_reproduce(CommandLine& line) {
  auto options = std::make_shared<ReproduceOptions>();
  Command command = line.command("reproduce", "Run the thesis's experiments and judge its claims");
  command.add("--only", options->only, "ids of claims, separated by commas").comma_separated();
  command.add("--out", options->out, "directory of the results (default: results/out/reproduce)");
  command.add("--ledger", options->ledger, "the ledger, JSON; a Markdown table beside it (default: OUT/claims.json)");
  command.flag("--anew", options->anew, "run every scenario, current results or not");
  command.add("--jobs", options->jobs, "runs at once (default: one for each processor)").range(1, 1024);
  add_cache_option(command, options->no_cache);
  add_output_options(command, options->output);
  command.runs([options] { return reproduce(*options); });
}

}  // namespace hapbench
