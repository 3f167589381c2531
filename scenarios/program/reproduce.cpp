#include "scenarios/program/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/assumption_runs.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/evidence.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "scenarios/thesis/sensitivity.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions : CommonOptions {
  std::vector<std::string> only;
  std::string ledger;
  bool rerun = false;
  std::string assumptions, sensitivity;  ///< files of the options with these names; empty without the option

  fs::path folder() const { return results_directory(out, "reproduce"); }
  fs::path runs() const { return folder() / "thesis"; }
};

/// Returns the claims with these ids, which may be in upper or lower case. If `ids` is empty, returns all claims.
/// Throws InputError for an unknown id.
std::vector<Claim> chosen_claims(const std::vector<std::string>& ids) {
  std::vector<Claim> claims = all_claims();
  if (ids.empty()) return claims;
  const std::vector<std::string> valid = names_of(claims, &Claim::id);
  std::set<std::string> chosen;
  for (const std::string& id : ids) {
    const auto found = std::ranges::find(valid, lower_case(id), lower_case);
    if (found == valid.end()) require_valid_option("--only", id, valid, "hapbench describe claims");
    chosen.insert(*found);
  }
  std::erase_if(claims, [&chosen](const Claim& claim) { return !chosen.contains(claim.id); });
  return claims;
}

/// Returns true if the directory has results of exactly this scenario, computed by exactly this program.
bool is_current(const fs::path& directory, const LoadedScenario& loaded) {
  try {
    const Json summary = read_json(directory / "summary.json");
    const Json& made = summary.at("provenance");
    return made.at("scenario_hash") == scenario_hash(effective_scenario(loaded.scenario, {}), loaded.files) &&
           made.at("commit") == provenance().commit && provenance().identifies_source();
  } catch (const std::exception&) {
    return false;  // the results are missing, damaged or of another version
  }
}

/// A scenario of the thesis, and its run by this command.
struct ThesisRun : BundledScenario {
  std::optional<double> seconds = {};   ///< duration of the run [s]; empty before the run
  std::vector<std::string> unmet = {};  ///< expectations of the scenario that the run does not meet
};

/// Returns the folders of the runs.
std::vector<fs::path> run_folders(const ReproduceOptions& options, const std::vector<ThesisRun>& runs) {
  std::vector<fs::path> folders;
  for (const ThesisRun& run : runs) folders.push_back(options.runs() / run.name);
  return folders;
}

/// Creates the folder of the file that an option names, and locks the file and the files next to it. Throws InputError,
/// with the option's name, if the file cannot be written.
FolderLock locked_file(const fs::path& file, const char* option, ProgramContext& context) {
  std::error_code ignored;
  // The other files of a ledger have the same name with another extension.
  if (file.extension() != ".json" || fs::is_directory(file, ignored))
    fail_in_option(option, fmt::format("got \"{}\"; allowed: a file name that ends in .json", file.string()));
  return locked_results(context, file.has_parent_path() ? file.parent_path() : ".", file.filename().string(),
                        "reproduce", option);
}

/// Runs the scenario and writes its results to a subdirectory of `directory`. Does nothing if this command has already
/// called provide() for the scenario. If `rerun` is false and the subdirectory has current results (is_current()),
/// keeps these results and does not run the scenario.
void provide(ThesisRun& run, const fs::path& directory, bool rerun) {
  if (run.seconds) return;
  run.seconds = seconds_of([&] {
    const fs::path results = directory / run.name;
    const CheckedScenario scene = checked(load_scenario(run.file));
    if (rerun || !is_current(results, scene.loaded())) run.unmet = run_scenario(scene, results, false).unmet;
  });
}

/// Judges the claims by the results of the thesis's scenarios. If a claim needs a scenario that has no current results
/// (is_current()), runs this scenario first.
std::vector<JudgedClaim> judge(const std::vector<Claim>& claims, const PublishedNumbers& published,
                               const Assumptions& assumptions, std::vector<ThesisRun>& runs,
                               const ReproduceOptions& options, const ProgramContext& context) {
  std::vector<JudgedClaim> judged;
  Measurements measurements;
  std::map<Measure, double> measuring;  // time of each measurement without the runs of scenarios [s]
  ProgressBar bar(options.output.quiet ? "" : "judging claims", claims.size(), context.progress);
  for (const Claim& claim : claims) {
    bar.show(judged.size());
    std::set<std::string> used;  // scenarios that the claim uses
    double providing = 0.0;      // time of the calls of provide() [s]
    const auto run_of = [&](const std::string& scenario) {
      return std::ranges::find(runs, scenario, &ThesisRun::name);
    };
    const auto provide_run = [&](const std::string& scenario) {
      used.insert(scenario);
      if (const auto run = run_of(scenario); run != runs.end())
        providing += seconds_of([&] { provide(*run, options.runs(), options.rerun); });
    };
    Finding finding;
    const Evidence evidence{
        published, options.runs(), provide_run, {}, [&](const std::string& scenario) { used.insert(scenario); }};
    const double took = seconds_of([&] { finding = measurements.finding(claim, evidence); });
    // The time of a claim includes the runs of its scenarios, and the measurement that it shares with other claims.
    double seconds = measuring.try_emplace(claim.measure, took - providing).first->second;
    for (const std::string& scenario : used)
      if (const auto run = run_of(scenario); run != runs.end()) seconds += run->seconds.value_or(0.0);
    const std::vector<std::string> scenarios(used.begin(), used.end());
    judged.push_back({claim, std::move(finding), scenarios, assumptions.reach(scenarios, claim.rule_texts()), seconds});
  }
  return judged;
}

std::string claims_text(const std::vector<JudgedClaim>& judged, const Layout& layout) {
  std::string text;
  for (const JudgedClaim& j : judged) {
    text += "\n" + layout.entry(j.claim.id, "claim: " + j.claim.claim, 0, 5);
    if (!j.finding.why.empty()) text += layout.entry("", "why: " + j.finding.why, 0, 5);
  }
  return text;
}

Columns<Json> claim_columns() {
  Columns<Json> columns;
  const auto add = [&columns](const char* key, const char* meaning) {
    const auto value = [key](const Json& claim) { return claim.at(key).get<std::string>(); };
    columns.add({{key, "", meaning, value, only_printed()}});
  };
  add("id", "id of a claim; \"hapbench describe ID\" explains it");
  add("verdict", "verdict on the claim");
  add("robustness", "assumptions for which another plausible value changes the verdict");
  add("number", "measured number that decides the verdict");
  return columns;
}

/// Judges claims under other assumptions, for --assumptions or --sensitivity. Writes no ledger.
int reproduce_otherwise(const ReproduceOptions& options, const std::vector<Claim>& claims, ProgramContext& context) {
  if (!options.ledger.empty())
    fail_in_option("--ledger",
                   "the ledger has the recorded assumptions; allowed: without --assumptions and "
                   "--sensitivity");
  if (!options.assumptions.empty() && !options.sensitivity.empty())
    fail_in_option("--sensitivity", "allowed: without --assumptions");
  Report report(options, kReproduceFiles, "reproduce", context);
  const fs::path scratch = options.folder() / "assumption_runs";
  if (options.sensitivity.empty()) {
    report_assumption_sets(claims, options.assumptions, scratch, options, report, context);
  } else {
    const FolderLock lock = locked_file(options.sensitivity, "--sensitivity", context);
    record_sensitivity(claims, all_claims(), options.sensitivity, scratch, options, report, context);
  }
  return report.finish();
}

int reproduce(const ReproduceOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  const fs::path reference = installed_folder("results/reference");
  const std::vector<Claim> claims = chosen_claims(options.only);
  if (!options.assumptions.empty() || !options.sensitivity.empty())
    return reproduce_otherwise(options, claims, context);
  const Assumptions assumptions(reference / "assumptions.json");
  const PublishedNumbers published =
      assumptions.with_numbers(PublishedNumbers(reference / "published.json"), assumptions.recorded_values());
  Report report(options, kReproduceFiles, "reproduce", context);
  std::vector<ThesisRun> runs;
  for (const BundledScenario& bundled : bundled_scenarios())
    if (bundled.group == "thesis") runs.push_back({bundled});
  // With --only and without --ledger, no ledger is written: it would replace the ledger of all claims.
  const fs::path ledger =
      options.ledger.empty() && options.only.empty() ? options.folder() / "claims.json" : fs::path(options.ledger);
  std::optional<FolderLock> ledger_lock;
  if (!ledger.empty()) ledger_lock.emplace(locked_file(ledger, "--ledger", context));
  require_unlocked(run_folders(options, runs), kRunFiles);
  // Without --only, make all runs first, in parallel. With --only, judge() makes the runs that the claims need.
  if (options.only.empty())
    for_each_job(runs.size(), job_options(options, "thesis", context),
                 [&](std::size_t i) { provide(runs[i], options.runs(), options.rerun); });

  const std::vector<JudgedClaim> judged = judge(claims, published, assumptions, runs, options, context);
  report.json() = ledger_json(judged, published, SensitivityRecord(reference / "sensitivity.json"));
  const Json& json = report.json();
  if (options.only.empty()) report.add_text(layout.wrapped(json.at("headline").get<std::string>()) + "\n\n");
  report.show(claim_columns().table(json.at("claims").get<std::vector<Json>>(), "claims", layout.in_full()));
  report.add_text(layout.wrapped(
      "robustness: the assumptions that change the verdict, each alone at another plausible value; \"hapbench describe "
      "assumptions\" lists them",
      0));
  if (!options.only.empty()) report.add_text(claims_text(judged, layout));
  if (!ledger.empty()) {
    report.files().write(ledger, json_text(json));
    report.files().write(fs::path(ledger).replace_extension(".md"), ledger_markdown(json));
    report.files().write(ledger.parent_path() / "claim_pages.md", claim_pages(json));
    report.add_text(fmt::format("\nledger in {}\n", ledger.string()));
  } else {
    report.add_text("\nno ledger (table of all claims) is written for single claims; --ledger FILE writes it\n");
  }
  for (const ThesisRun& run : runs)
    for (const std::string& problem : run.unmet)
      report.fault(fmt::format("{}: {}", run.name, problem), kUnexpectedOutcome);
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> claim_tables() {
  std::vector<DescribedTable> tables = {claim_columns().described()};
  std::ranges::move(assumption_tables(), std::back_inserter(tables));
  return tables;
}

void add_reproduce(CommandLine& line) {
  auto [command, options] =
      line.command("reproduce", "Run the experiments of the thesis and judge its claims.", reproduce,
                   "finished runs are kept, and the same command continues from there");
  command.add("--only <id,...>", options.only, "judge only these claims; \"hapbench describe claims\" lists the ids",
              {.comma_separated = true});
  add_out(command, options.out, "reproduce");
  command.add(
      "--ledger <file.json>", options.ledger,
      "file of the ledger, with claims.md and claim_pages.md next to it (default: OUT/claims.json; with --only, no "
      "ledger is written unless this option is given)");
  command.flag("--rerun", options.rerun, "repeat all runs, also those whose results are current");
  add_jobs(command, options.jobs);
  add_table(command, options.output);
  command.add("--assumptions <file.csv>", options.assumptions,
              "judge claims under other assumptions instead: one set per row, one column per assumption");
  command.add("--sensitivity <file.json>", options.sensitivity,
              "judge claims with one assumption at a time at another value, and add the verdicts to this record");
  command.footer(
      "Files: the ledger as claims.md (to read first: claim, published and measured value, verdict), claim_pages.md (a "
      "section for each claim) and claims.json (for programs); the runs in OUT/thesis.\n\n"
      "Figures: the script scripts/reproduce runs this command and also draws the figures of the thesis.\n\n"
      "Assumptions: the thesis leaves them open; \"hapbench describe assumptions\" lists them. --assumptions prints, "
      "for each set, the verdicts and numbers of the claims that the set can change, and the recorded verdicts that "
      "differ. --sensitivity with an existing file continues its record. The ledger always takes robustness from "
      "results/reference/sensitivity.json.\n\n"
      "Earlier results: runs in OUT/thesis of the same scenario by the same build are used again, unless the build has "
      "uncommitted changes; a ledger is replaced.\n\n"
      "Time: about a minute on two processors for all claims, or for an assumption set that changes all claims. A "
      "single claim takes seconds to a minute, a whole record of --sensitivity about an hour of one processor.\n\n"
      "Exit status: 0 whatever the verdicts are; 3 if a run did not end as its scenario expects; 130 stopped by "
      "Ctrl-C.");
}

}  // namespace hapbench
