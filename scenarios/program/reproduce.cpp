#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/cases/cases.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "scenarios/thesis/robustness.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions : CommonOptions {
  std::vector<std::string> only;
  std::string ledger;
  bool anew = false;
  std::string readings;  ///< file; empty for none

  fs::path folder() const { return results_directory(out, "reproduce"); }
};

std::vector<Claim> chosen_claims(const std::vector<std::string>& ids) {
  std::vector<Claim> claims = all_claims();
  if (ids.empty()) return claims;
  const std::vector<std::string> valid = names_of(claims, &Claim::id);
  std::set<std::string> chosen;
  for (const std::string& id : ids) {
    const auto found = std::ranges::find(valid, lower_case(id), lower_case);
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
  explicit ThesisRuns(const ReproduceOptions& options)
      : directory_(options.folder() / "thesis"), anew_(options.anew), scenarios_(bundled_scenarios()) {
    std::erase_if(scenarios_, [](const BundledScenario& bundled) { return bundled.group != "thesis"; });
  }

  const fs::path& directory() const { return directory_; }

  /// Runs all of them on several threads.
  void run_all(const JobOptions& jobs) {
    std::vector<std::vector<std::string>> unmet(scenarios_.size());
    std::vector<double> seconds(scenarios_.size());
    for_each_job(unmet.size(), jobs,
                 [&](std::size_t i) { seconds[i] = seconds_of(1, [&] { unmet[i] = run(scenarios_[i]); }); });
    for (std::size_t i = 0; i < unmet.size(); ++i) {
      unmet_[scenarios_[i].name] = unmet[i];
      seconds_[scenarios_[i].name] = seconds[i];
    }
  }

  /// Runs one of them unless that has been done.
  void provide(const std::string& name) {
    const auto bundled = std::ranges::find(scenarios_, name, &BundledScenario::name);
    if (bundled != scenarios_.end() && !unmet_.contains(name))
      seconds_[name] = seconds_of(1, [&] { unmet_[name] = run(*bundled); });
  }

  /// Those that a run took; 0 for results that were current.
  double seconds(const std::string& name) const { return seconds_.contains(name) ? seconds_.at(name) : 0.0; }

  /// What runs did otherwise than their scenarios expect, by their names.
  const std::map<std::string, std::vector<std::string>>& unmet() const { return unmet_; }

 private:
  std::vector<std::string> run(const BundledScenario& bundled) const {
    const LoadedScenario loaded = checked(load_scenario(bundled.file));
    if (!anew_ && is_current(directory_ / bundled.name, loaded)) return {};
    return run_scenario(loaded, directory_ / bundled.name, false).unmet;
  }

  fs::path directory_;
  bool anew_;
  std::vector<BundledScenario> scenarios_;
  std::map<std::string, std::vector<std::string>> unmet_;
  std::map<std::string, double> seconds_;
};

/// Judges the claims by the thesis's runs.
std::vector<JudgedClaim> judge(const std::vector<Claim>& claims, const PublishedNumbers& published,
                               const Choices& choices, ThesisRuns& runs, bool progress) {
  std::set<std::string> used;  // scenarios of the current claim
  const auto note = [&](const std::string& scenario) { used.insert(scenario); };
  double providing = 0.0, running = 0.0;  // seconds of the current claim: for what others share, of its own runs
  std::set<std::string> provided;
  const auto provide = [&](const std::string& scenario) {
    note(scenario);
    providing += seconds_of(1, [&] { runs.provide(scenario); });
    if (provided.insert(scenario).second) running += runs.seconds(scenario);
  };
  const Evidence evidence{published, runs.directory(), provide, {}, note};
  std::vector<JudgedClaim> judged;
  ProgressBar bar("claims", claims.size(), progress);
  for (const Claim& claim : claims) {
    bar.show(judged.size());
    used.clear();
    provided.clear();
    providing = running = 0.0;
    Finding finding;
    const double measuring = seconds_of(1, [&] { finding = claim.finding(evidence); }) - providing;
    const std::vector<std::string> scenarios(used.begin(), used.end());
    judged.push_back({claim, std::move(finding), scenarios, choices.reach(scenarios, claim.rule), running + measuring});
  }
  return judged;
}

/// The content of robustness.json; an empty record when there is no such file.
Json read_record(const fs::path& file) {
  if (!fs::exists(file)) return {{"claims", Json::array()}};
  return parse_json(read_text_file(file, kLargestJsonFile));
}

/// Judges the claims again under the readings, and writes robustness.* into `directory` if one is given. Returns the
/// content of robustness.json.
Json judge_readings(const ReproduceOptions& options, const Readings& readings,
                    const std::optional<fs::path>& directory) {
  const fs::path scratch = options.folder() / "robustness";
  std::vector<ReadingVerdicts> judged(readings.values.size());
  for_each_job(judged.size(), job_options(options, "robustness"),
               [&](std::size_t i) { judged[i] = judge_reading(readings, i, scratch / std::to_string(i)); });
  std::error_code ignored;
  fs::remove(scratch, ignored);
  std::vector<std::string> problems;
  for (const ReadingVerdicts& reading : judged)
    for (const std::string& problem : reading.problems) problems.push_back("not measured: " + one_line(problem));
  for (const std::string& problem : first_few(problems, 10)) print_error(problem);
  // Readings of single claims leave those of the others as they are.
  const bool some = directory && !options.only.empty() && fs::exists(*directory / "robustness.json");
  const Json record =
      robustness_json(readings, judged, some ? read_record(*directory / "robustness.json") : Json::object());
  if (directory) {
    FileSet files;
    if (!some) files.write(*directory / "robustness.csv", robustness_table(readings, judged));
    files.write(*directory / "robustness.json", json_text(record));
    files.commit();
  }
  return record;
}

/// The file of the ledger. None for single claims unless --ledger is given: they would replace the ledger of all
/// claims.
std::optional<fs::path> ledger_file(const ReproduceOptions& options) {
  if (!options.ledger.empty()) return options.ledger;
  if (!options.only.empty()) return {};
  return options.folder() / "claims.json";
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
  const auto text_of = [](const char* key) {
    return [key](const Json& claim) { return claim.at(key).get<std::string>(); };
  };
  columns.print("id", "", "id of a claim, which describe explains", text_of("id"));
  columns.print("verdict", "", "on the claim", text_of("verdict"));
  columns.print("sureness", "",
                "steady: more than half of the samples of the choices on record have the verdict; else fragile, or not "
                "sampled",
                text_of("sureness"));
  columns.print("measured", "", "what the claim's verdict is about", text_of("measured"));
  return columns;
}

int reproduce(const ReproduceOptions& options) {
  const fs::path reference = installed_folder("results/reference");
  const std::vector<Claim> claims = chosen_claims(options.only);
  const Choices choices(reference / "choices.json");
  const PublishedNumbers published =
      choices.with_numbers(PublishedNumbers(reference / "published.json"), choices.values_on_record());
  Readings readings{choices, published, {}, {}};
  if (!options.readings.empty()) readings.values = read_readings(options.readings, choices);
  Report report(options, "reproduce");
  ThesisRuns runs(options);
  // Single claims run only the scenarios they need.
  if (options.only.empty()) runs.run_all(job_options(options, "thesis"));

  const std::vector<JudgedClaim> judged = judge(claims, published, choices, runs, !options.output.quiet);
  const std::optional<fs::path> ledger = ledger_file(options);
  Json robustness = read_record(reference / "robustness.json");
  if (!readings.values.empty()) {
    readings.claims = judged;
    std::erase_if(readings.claims, [](const JudgedClaim& j) { return !j.can_be_sampled(); });
    robustness = judge_readings(options, readings, ledger ? std::optional(ledger->parent_path()) : std::nullopt);
  }

  report.json() = ledger_json(judged, published, robustness);
  const Json& json = report.json();
  if (options.only.empty()) report.say(wrapped(json.at("headline").get<std::string>()) + "\n\n");
  report.say(claim_columns().table(json.at("claims").get<std::vector<Json>>()).text());
  if (!options.only.empty()) report.say(claims_text(judged));
  if (ledger) {
    report.files().write(*ledger, json_text(json));
    report.files().write(fs::path(*ledger).replace_extension(".md"), ledger_markdown(json));
    report.say(fmt::format("\nledger in {}\n", ledger->string()));
  } else {
    report.say("\nno ledger is written of single claims without --ledger FILE\n");
  }
  for (const auto& [scenario, unmet] : runs.unmet())
    for (const std::string& problem : unmet) report.fault(fmt::format("{}: {}", scenario, problem), kUnexpectedOutcome);
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> claim_tables() {
  return {claim_columns().described()};
}

void add_reproduce(CommandLine& line) {
  auto [command, options] = line.command("reproduce", "Run the thesis's experiments and judge its claims", reproduce,
                                         "finished runs are kept, and the same command continues from there");
  command.add(
      "--only", options.only,
      "ids of claims, separated by commas; \"hapbench describe claims\" shows them, and scripts/reproduce --only draws their "
      "figures",
      {.comma_separated = true});
  command.add("--out", options.out, "directory of the results (default: results/out/reproduce)");
  command.add(
      "--ledger", options.ledger,
      "file of the ledger, JSON, with a Markdown table next to it (default: OUT/claims.json; with --only none)");
  command.flag("--anew", options.anew, "run every scenario again, even where results are current");
  add_jobs(command, options.jobs);
  command.add(
      "--choices", options.readings,
      "judge every claim again under each reading of FILE.csv, appendix D in the first quarter of them: a row each, a "
      "column for each choice that it reads otherwise than on record, as results/reference/readings.csv; writes "
      "robustness.csv and .json next to the ledger, if there is one; with --only, .json keeps what it has of other "
      "claims");
  command.footer(
      "results/reference/choices.json has what the thesis leaves open; scripts/readings.py draws readings of it.\n"
      "Exit status: 0 success, 2 bad input or usage, 3 a run did not end as its scenario expects, 130 stopped by Ctrl-C.");
}

}  // namespace hapbench
