#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/text_lines.hpp"
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
    const Json summary = read_json(directory / "summary.json");
    const Json& made = summary.at("provenance");
    return made.at("scenario_hash") == scenario_hash(loaded.scenario, loaded.files) &&
           made.at("commit") == provenance().commit && provenance().identifies_source();
  } catch (const std::exception&) {
    return false;  // missing, damaged or of another version: run it
  }
}

/// A scenario of the thesis, and what came of it.
struct ThesisRun : BundledScenario {
  bool is_done = false;
  std::vector<std::string> unmet = {};  ///< what the run did otherwise than the scenario expects
  double seconds = 0.0;
};

/// Runs the thesis's scenarios into subdirectories, except those whose results are current.
class ThesisRuns {
 public:
  explicit ThesisRuns(const ReproduceOptions& options) : directory_(options.folder() / "thesis"), anew_(options.anew) {
    for (const BundledScenario& bundled : bundled_scenarios())
      if (bundled.group == "thesis") runs_.push_back({bundled});
  }

  const fs::path& directory() const { return directory_; }
  const std::vector<ThesisRun>& runs() const { return runs_; }

  /// Runs all of them on several threads.
  void run_all(const JobOptions& jobs) {
    for_each_job(runs_.size(), jobs, [&](std::size_t i) { run(runs_[i]); });
  }

  /// Runs one of them unless that has been done. Returns the seconds that it took; 0 for a scenario of another group.
  double provide(const std::string& name) {
    const auto found = std::ranges::find(runs_, name, &ThesisRun::name);
    if (found == runs_.end()) return 0.0;
    if (!found->is_done) run(*found);
    return found->seconds;
  }

 private:
  void run(ThesisRun& made) const {
    made.seconds = seconds_of(1, [&] {
      const LoadedScenario loaded = checked(load_scenario(made.file));
      if (anew_ || !is_current(directory_ / made.name, loaded))
        made.unmet = run_scenario(loaded, directory_ / made.name, false).unmet;
    });
    made.is_done = true;
  }

  fs::path directory_;
  bool anew_;
  std::vector<ThesisRun> runs_;
};

/// Judges the claims by the thesis's runs.
std::vector<JudgedClaim> judge(const std::vector<Claim>& claims, const PublishedNumbers& published,
                               const Choices& choices, ThesisRuns& runs, bool progress) {
  std::vector<JudgedClaim> judged;
  ProgressBar bar("claims", claims.size(), progress);
  for (const Claim& claim : claims) {
    bar.show(judged.size());
    std::set<std::string> used, provided;   // scenarios
    double providing = 0.0, running = 0.0;  // seconds: for what others share, of the claim's own runs
    const auto note = [&](const std::string& scenario) { used.insert(scenario); };
    const auto provide = [&](const std::string& scenario) {
      note(scenario);
      double seconds = 0.0;
      providing += seconds_of(1, [&] { seconds = runs.provide(scenario); });
      if (provided.insert(scenario).second) running += seconds;
    };
    Finding finding;
    const Evidence evidence{published, runs.directory(), provide, {}, note};
    const double measuring = seconds_of(1, [&] { finding = claim.finding(evidence); }) - providing;
    const std::vector<std::string> scenarios(used.begin(), used.end());
    judged.push_back({claim, std::move(finding), scenarios, choices.reach(scenarios, claim.rule), running + measuring});
  }
  return judged;
}

/// The content of robustness.json; an empty record when there is no such file.
Json read_record(const fs::path& file) {
  if (!fs::exists(file)) return {{"claims", Json::array()}};
  return read_json(file);
}

/// Judges the claims again under the readings, and writes robustness.* next to the ledger, if there is one. Returns the
/// content of robustness.json.
Json judge_readings(const ReproduceOptions& options, const Readings& readings, const fs::path& ledger) {
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
  const fs::path file = ledger.parent_path() / "robustness.json";
  const bool some = !ledger.empty() && !options.only.empty() && fs::exists(file);
  const Json record = robustness_json(readings, judged, some ? read_record(file) : Json::object());
  if (ledger.empty()) return record;
  FileSet files;
  if (!some) files.write(ledger.parent_path() / "robustness.csv", robustness_table(readings, judged));
  files.write(file, json_text(record));
  files.commit();
  return record;
}

/// The file of the ledger. Empty for single claims unless --ledger is given: they would replace the ledger of all
/// claims.
fs::path ledger_file(const ReproduceOptions& options) {
  return options.ledger.empty() && options.only.empty() ? options.folder() / "claims.json" : fs::path(options.ledger);
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
  const auto add = [&columns](const char* key, const char* meaning) {
    columns.print(key, "", meaning, [key](const Json& claim) { return claim.at(key).get<std::string>(); });
  };
  add("id", "id of a claim, which describe explains");
  add("verdict", "on the claim");
  add("sureness",
      "steady: more than half of the samples of the choices on record have the verdict; else fragile, or not sampled");
  add("measured", "what the claim's verdict is about");
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
  const fs::path ledger = ledger_file(options);
  Json robustness = read_record(reference / "robustness.json");
  if (!readings.values.empty()) {
    readings.claims = judged;
    std::erase_if(readings.claims, [](const JudgedClaim& j) { return !j.can_be_sampled(); });
    robustness = judge_readings(options, readings, ledger);
  }

  report.json() = ledger_json(judged, published, robustness);
  const Json& json = report.json();
  if (options.only.empty()) report.say(wrapped(json.at("headline").get<std::string>()) + "\n\n");
  report.say(claim_columns().table(json.at("claims").get<std::vector<Json>>()).text());
  if (!options.only.empty()) report.say(claims_text(judged));
  if (!ledger.empty()) {
    report.files().write(ledger, json_text(json));
    report.files().write(fs::path(ledger).replace_extension(".md"), ledger_markdown(json));
    report.say(fmt::format("\nledger in {}\n", ledger.string()));
  } else {
    report.say("\nno ledger is written of single claims without --ledger FILE\n");
  }
  for (const ThesisRun& run : runs.runs())
    for (const std::string& problem : run.unmet)
      report.fault(fmt::format("{}: {}", run.name, problem), kUnexpectedOutcome);
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
  add_out(command, options.out, "reproduce");
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
