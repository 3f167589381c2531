#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis_claims/ledger.hpp"
#include "scenarios/thesis_claims/robustness.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
  std::vector<std::string> only;
  std::string out = (fs::path("results") / "out" / "reproduce").string();
  std::string ledger;
  bool anew = false;
  std::int64_t samples = 0;  ///< of the choices; 0 for none
  std::size_t jobs = available_threads();
  OutputOptions output;
};

std::vector<std::string> claim_ids() {
  return names_of(all_claims(), &Claim::id);
}

std::vector<Claim> chosen_claims(const std::vector<std::string>& ids) {
  std::vector<Claim> claims = all_claims();
  if (ids.empty()) return claims;
  const std::vector<std::string> valid = claim_ids();
  std::set<std::string> chosen;
  for (const std::string& id : ids) {
    const auto same = [&id](const std::string& other) { return lower_case(other) == lower_case(id); };
    const auto found = std::find_if(valid.begin(), valid.end(), same);
    if (found == valid.end()) require_valid_name("--only: got", id, valid);
    chosen.insert(*found);
  }
  std::erase_if(claims, [&chosen](const Claim& claim) { return !chosen.contains(claim.id); });
  return claims;
}

/// Returns true if the directory holds results of exactly this scenario, computed by exactly this program.
bool is_current(const fs::path& directory, const LoadedScenario& loaded) {
  try {
    const Json summary = parse_json(read_text_file(directory / "summary.json", kLargestJsonFile));
    const Json& made = summary.at("provenance");
    return made.at("scenario_hash") == scenario_hash(loaded.scenario, loaded.files) &&
           made.at("commit") == provenance().commit && !provenance().identity().empty();
  } catch (const std::exception&) {
    return false;  // missing, damaged or of another version: run it
  }
}

/// Runs the thesis's scenarios into subdirectories, except those whose results are current.
class ThesisRuns {
 public:
  ThesisRuns(const ReproduceOptions& options) : directory_(fs::path(options.out) / "thesis"), anew_(options.anew) {
    for (const BundledScenario& bundled : bundled_scenarios()) {
      if (bundled.group == "thesis") scenarios_.push_back(bundled);
    }
  }

  const fs::path& directory() const { return directory_; }

  /// Runs all of them on several threads.
  void run_all(std::size_t jobs, bool progress) {
    ProgressBar bar("thesis", scenarios_.size(), progress);
    std::size_t begun = 0, done = 0;
    const auto next = [&] { return begun < scenarios_.size() ? std::optional(begun++) : std::nullopt; };
    const auto work = [&](std::size_t i) -> Delivery {
      std::vector<std::string> problems = run(scenarios_[i]);
      return [&, i, problems = std::move(problems)] {
        tell(scenarios_[i], problems);
        bar.show(++done, true);
      };
    };
    parallel_for(next, jobs, work);
  }

  /// Runs one of them unless that has been done.
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
    return run_scenario(loaded, directory_ / bundled.name, false).unmet;
  }
  void tell(const BundledScenario& bundled, const std::vector<std::string>& problems) {
    done_.insert(bundled.name);
    as_expected_ = as_expected_ && problems.empty();
    for (const std::string& problem : problems) print_error(fmt::format("{}: {}", bundled.name, problem));
  }

  fs::path directory_;
  bool anew_;
  std::vector<BundledScenario> scenarios_;
  std::set<std::string> done_;
  bool as_expected_ = true;
};

/// Judges the claims by the thesis's runs, and notes in `read` which results that needs.
std::vector<JudgedClaim> judge(const std::vector<Claim>& claims, const PublishedNumbers& published,
                               const Choices& choices, ThesisRuns& runs, ResultsRead& read, bool progress) {
  std::set<std::string> used;  // scenarios of the current claim
  const auto provide = [&](const std::string& scenario, const std::string& part) {
    used.insert(scenario);
    read[scenario].insert(part);
    runs.provide(scenario);
  };
  const Evidence evidence{published, ResultFiles(runs.directory(), provide), {}, [&](const std::string& scenario) {
                            used.insert(scenario);
                          }};
  std::vector<JudgedClaim> judged;
  ProgressBar bar("claims", claims.size(), progress);
  for (const Claim& claim : claims) {
    bar.show(judged.size());
    used.clear();
    Finding finding = claim.judge(claim.measure(evidence), published);
    const std::vector<std::string> scenarios(used.begin(), used.end());
    judged.push_back({claim, std::move(finding), scenarios, choices.reach(scenarios, claim.rule)});
  }
  return judged;
}

std::vector<JudgedClaim> to_judge_again(std::vector<JudgedClaim> judged) {
  std::erase_if(judged, [](const JudgedClaim& j) { return !j.can_be_sampled(); });
  return judged;
}

/// Prints the first few problems of a sample's runs.
void print_problems(const std::vector<std::string>& problems) {
  constexpr std::size_t kMost = 10;
  for (std::size_t i = 0; i < std::min(problems.size(), kMost); ++i) {
    print_error(fmt::format("not measured: {}", one_line(problems[i])));
  }
  if (problems.size() > kMost) print_error(fmt::format("{} more like these", problems.size() - kMost));
}

/// The content of robustness.json, and the signal that stopped the samples, or 0.
struct SampledRobustness {
  Json record;
  int signal = 0;
};

/// Judges the claims again at samples of the choices, and writes robustness.* into `directory` if one is given.
SampledRobustness sample_robustness(const ReproduceOptions& options, const RobustnessPlan& plan,
                                    const std::vector<JudgedClaim>& on_record,
                                    const std::optional<fs::path>& directory) {
  RobustnessReport report = run_robustness(plan, {options.out, options.jobs, options.anew, !options.output.quiet});
  print_problems(report.problems);
  if (report.signal != 0) {
    fmt::print(stderr, "hapbench: stopped after {} of {} samples; the same command continues from there\n", report.done,
               plan.samples());
    return {{}, report.signal};
  }
  std::vector<std::string> verdicts;
  for (const JudgedClaim& j : on_record) verdicts.emplace_back(verdict_name(j.finding.verdict));
  const std::vector<ClaimRobustness> robustness = robustness_of(plan, verdicts, report.verdicts);
  // Samples of single claims leave those of the others as they are.
  const bool some = directory && !options.only.empty() && fs::exists(*directory / "robustness.json");
  const Json before =
      some ? parse_json(read_text_file(*directory / "robustness.json", kLargestJsonFile)) : Json::object();
  const Json record = robustness_json(plan, on_record, robustness, before);
  if (directory) {
    FileSet files;
    if (!some) files.write(*directory / "robustness.csv", robustness_table(plan, report.verdicts));
    files.write(*directory / "robustness.json", json_text(record));
    files.write(*directory / "robustness.md", robustness_markdown(record));
    files.commit();
  }
  return {record};
}

/// The file of the ledger. None for single claims unless --ledger is given: they would replace the ledger of all
/// claims.
std::optional<fs::path> ledger_file(const ReproduceOptions& options) {
  if (!options.ledger.empty()) return options.ledger;
  if (!options.only.empty()) return {};
  return fs::path(options.out) / "claims.json";
}

/// States each claim and the reason for its verdict.
std::string claims_text(const std::vector<JudgedClaim>& judged) {
  std::string text;
  for (const JudgedClaim& j : judged) {
    text += "\n" + entry(j.claim.id, j.claim.claim, 0, 5);
    if (!j.finding.why.empty()) text += entry("", "why: " + j.finding.why, 0, 5);
  }
  return text;
}

/// The claims of the ledger.
Columns<Json> claim_columns() {
  Columns<Json> columns;
  columns.print("id", "", "id of a claim, which describe explains",
                [](const Json& claim) { return claim.at("id").get<std::string>(); });
  columns.print("verdict", "", "on the claim; where most samples of the choices have another one, that in brackets",
                verdicts_text);
  columns.print(
      "robustness", "",
      "the share of the samples of the choices on record in which the verdict is the same, and what decides it",
      robustness_text);
  columns.print("measured", "", "what the claim's verdict is about",
                [](const Json& claim) { return claim.at("measured").get<std::string>(); });
  return columns;
}

int reproduce(const ReproduceOptions& options) {
  const fs::path reference = installed_folder("results/reference");
  const std::vector<Claim> claims = chosen_claims(options.only);
  const Choices choices(reference / "choices.json");
  const PublishedNumbers published =
      choices.with_numbers(PublishedNumbers(reference / "published"), choices.values_on_record());
  require_writable_directory(options.out);
  ThesisRuns runs(options);
  // Single claims run only the scenarios they need.
  if (options.only.empty()) runs.run_all(options.jobs, !options.output.quiet);

  ResultsRead read;
  const std::vector<JudgedClaim> judged = judge(claims, published, choices, runs, read, !options.output.quiet);
  const std::optional<fs::path> ledger = ledger_file(options);
  RobustnessOnRecord robustness(reference / "robustness.json");
  if (options.samples > 0) {
    const std::vector<JudgedClaim> again = to_judge_again(judged);
    std::vector<Claim> sampled;
    for (const JudgedClaim& j : again) sampled.push_back(j.claim);
    const RobustnessPlan plan =
        plan_robustness(choices, published, sampled, read, static_cast<std::size_t>(options.samples));
    const SampledRobustness sampled_robustness =
        sample_robustness(options, plan, again, ledger ? std::optional(ledger->parent_path()) : std::nullopt);
    if (sampled_robustness.signal != 0) return kStopped + sampled_robustness.signal;
    robustness = RobustnessOnRecord(sampled_robustness.record);
  }

  const Json json = ledger_json(judged, published, robustness);
  std::string text = options.only.empty() ? wrapped(json.at("headline").get<std::string>()) + "\n\n" : "";
  text += claim_columns().table(json.at("claims").get<std::vector<Json>>()).text();
  if (!options.only.empty()) text += claims_text(judged);
  if (ledger) {
    FileSet files;
    files.write(*ledger, json_text(json));
    files.write(fs::path(*ledger).replace_extension(".md"), ledger_markdown(json));
    files.write(ledger->parent_path() / "choices.md", choices.markdown());
    files.commit();
    text += fmt::format("\nledger in {}\n", ledger->string());
  } else {
    text += "\nno ledger is written of single claims without --ledger FILE\n";
  }
  print(options.output, text, json);
  return runs.all_as_expected() ? kSuccess : kUnexpectedOutcome;
}

}  // namespace

std::vector<DescribedTable> claim_tables() {
  return {claim_columns().described()};
}

void add_reproduce(CommandLine& line) {
  auto [command, options] = line.command("reproduce", "Run the thesis's experiments and judge its claims", reproduce,
                                         "finished runs are kept, and the same command continues from there");
  command
      .add(
          "--only", options.only,
          "ids of claims, separated by commas; \"hapbench list claims\" shows them, and scripts/reproduce --only draws their "
          "figures, too")
      .comma_separated();
  command.add("--out", options.out, "directory of the results (default: results/out/reproduce)");
  command.add("--ledger", options.ledger,
              "file of the ledger, JSON, with a Markdown table beside it (default: OUT/claims.json; with --only none)");
  command.flag("--anew", options.anew,
               "run every scenario and judge every sample again, even where results are current");
  command.add("--jobs", options.jobs, "runs at once (default: one for each processor)").range(1, 1024);
  command
      .add(
          "--robustness", options.samples,
          "judge every claim again at this many samples of the choices on record (default: 256), appendix D at a quarter "
          "of them; writes robustness.csv, .json and .md beside the ledger, if there is one; with --only, .json and .md keep "
          "what they have of other claims")
      .value_if_none("256")
      .range(4, 100'000);
  add_output_options(command, options.output);
  command.footer(
      "choices.md beside the ledger lists what the thesis leaves open (results/reference/choices.json). Ctrl-C stops "
      "--robustness after the samples under way; the same command continues from there.\n"
      "Exit status: 0 success, 2 bad input or usage, 3 a run did not end as its scenario expects, 130 stopped by Ctrl-C.");
}

}  // namespace hapbench
