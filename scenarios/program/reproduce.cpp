#include "scenarios/program/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/evidence.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "scenarios/thesis/robustness.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions : CommonOptions {
  std::vector<std::string> only;
  std::string ledger;
  bool rerun = false;
  std::string readings;  ///< file of --choices; empty for none

  fs::path folder() const { return results_directory(out, "reproduce"); }
  fs::path runs() const { return folder() / "thesis"; }
};

/// Returns the claims with these ids, in any case of letters; without ids all claims. Throws InputError.
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

/// Locks the ledger and the files next to it. Locks nothing if no ledger is written or its folder does not exist.
std::optional<FolderLock> locked_ledger(const fs::path& ledger, ProgramContext& context) {
  const fs::path folder = ledger.has_parent_path() ? ledger.parent_path() : ".";
  std::error_code ignored;
  if (ledger.empty() || !fs::is_directory(folder, ignored)) return std::nullopt;
  return locked_results(context, folder, ledger.filename().string(), "reproduce", "--ledger");
}

/// Runs the scenario and writes its results to a subdirectory of `directory`. Does nothing if the scenario was
/// run before. Keeps current results unless `rerun`.
void provide(ThesisRun& run, const fs::path& directory, bool rerun) {
  if (run.seconds) return;
  run.seconds = seconds_of(1, [&] {
    const fs::path results = directory / run.name;
    const CheckedScenario scene = checked(load_scenario(run.file));
    if (rerun || !is_current(results, scene.loaded())) run.unmet = run_scenario(scene, results, false).unmet;
  });
}

/// Judges the claims by the runs of the thesis's scenarios, and makes the missing runs first.
std::vector<JudgedClaim> judge(const std::vector<Claim>& claims, const PublishedNumbers& published,
                               const Choices& choices, std::vector<ThesisRun>& runs, const ReproduceOptions& options,
                               const ProgramContext& context) {
  std::vector<JudgedClaim> judged;
  ProgressBar bar(options.output.quiet ? "" : "claims", claims.size(), context.progress);
  for (const Claim& claim : claims) {
    bar.show(judged.size());
    std::set<std::string> used, provided;   // scenarios
    double providing = 0.0, running = 0.0;  // [s]: providing: time for runs that claims share; running: time for the
                                            // runs of this claim
    const auto note = [&](const std::string& scenario) { used.insert(scenario); };
    const auto provide_run = [&](const std::string& scenario) {
      note(scenario);
      const auto run = std::ranges::find(runs, scenario, &ThesisRun::name);
      if (run == runs.end()) return;  // a scenario of another group
      providing += seconds_of(1, [&] { provide(*run, options.runs(), options.rerun); });
      if (provided.insert(scenario).second) running += *run->seconds;
    };
    Finding finding;
    const Evidence evidence{published, options.runs(), provide_run, {}, note};
    const double measuring = seconds_of(1, [&] { finding = claim.finding(evidence); }) - providing;
    const std::vector<std::string> scenarios(used.begin(), used.end());
    judged.push_back({claim, std::move(finding), scenarios, choices.reach(scenarios, claim.rule), running + measuring});
  }
  return judged;
}

/// Judges the claims again under each reading. A reading is a set of values for the choices that the thesis leaves
/// open. Writes robustness.csv and robustness.json next to the ledger, if there is one. Returns the content of
/// robustness.json.
Json judge_readings(const ReproduceOptions& options, const Readings& readings, const fs::path& ledger, FileSet& files,
                    ProgramContext& context) {
  const fs::path scratch = options.folder() / "robustness";
  // Judge the claims under each reading.
  std::vector<ReadingVerdicts> judged(readings.values.size());
  for_each_job(judged.size(), job_options(options, "robustness", context),
               [&](std::size_t i) { judged[i] = judge_reading(readings, i, scratch / std::to_string(i)); });
  std::error_code ignored;
  fs::remove(scratch, ignored);
  // Report the claims that could not be measured.
  std::vector<std::string> problems;
  for (const ReadingVerdicts& reading : judged)
    for (const std::string& problem : reading.problems) problems.push_back("not measured: " + one_line(problem));
  for (const std::string& problem : first_few(problems, 10)) print_error(context, problem);
  // With --only, keep the entries of robustness.json for the other claims.
  const fs::path file = ledger.parent_path() / "robustness.json";
  const bool some = !ledger.empty() && !options.only.empty() && fs::exists(file);
  const Json record = robustness_json(readings, judged, some ? read_json(file) : Json::object());
  if (ledger.empty()) return record;
  if (!some) files.write(ledger.parent_path() / "robustness.csv", robustness_table(readings, judged));
  files.write(file, json_text(record));
  return record;
}

std::string claims_text(const std::vector<JudgedClaim>& judged, const Layout& layout) {
  std::string text;
  for (const JudgedClaim& j : judged) {
    text += "\n" + layout.entry(j.claim.id, j.claim.claim, 0, 5);
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
  add("id", "id of a claim, which describe explains");
  add("verdict", "on the claim");
  add("sureness",
      "steady: more than half of the samples of the choices on record have the verdict; else fragile, or not sampled");
  add("measured", "what the claim's verdict is about");
  return columns;
}

int reproduce(const ReproduceOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  const fs::path reference = installed_folder("results/reference");
  const std::vector<Claim> claims = chosen_claims(options.only);
  const Choices choices(reference / "choices.json");
  const PublishedNumbers published =
      choices.with_numbers(PublishedNumbers(reference / "published.json"), choices.values_on_record());
  Readings readings{choices, published, {}, {}};
  if (!options.readings.empty()) readings.values = read_readings(options.readings, choices);
  Report report(options, kReproduceFiles, "reproduce", context);
  std::vector<ThesisRun> runs;
  for (const BundledScenario& bundled : bundled_scenarios())
    if (bundled.group == "thesis") runs.push_back({bundled});
  // With --only and without --ledger, no ledger is written: it would replace the ledger of all claims.
  const fs::path ledger =
      options.ledger.empty() && options.only.empty() ? options.folder() / "claims.json" : fs::path(options.ledger);
  const std::optional<FolderLock> ledger_lock = locked_ledger(ledger, context);
  require_unlocked(run_folders(options, runs), kRunFiles);
  // Without --only, make all runs first, in parallel. With --only, judge() makes the runs that the claims need.
  if (options.only.empty())
    for_each_job(runs.size(), job_options(options, "thesis", context),
                 [&](std::size_t i) { provide(runs[i], options.runs(), options.rerun); });

  const std::vector<JudgedClaim> judged = judge(claims, published, choices, runs, options, context);
  // Use the stored robustness, or sample it anew with --choices.
  const fs::path on_record = reference / "robustness.json";
  Json robustness = fs::exists(on_record) ? read_json(on_record) : Json{{"claims", Json::array()}};
  if (!readings.values.empty()) {
    readings.claims = judged;
    std::erase_if(readings.claims, [](const JudgedClaim& j) { return !j.can_be_sampled(); });
    robustness = judge_readings(options, readings, ledger, report.files(), context);
  }

  report.json() = ledger_json(judged, published, robustness);
  const Json& json = report.json();
  if (options.only.empty()) report.say(layout.wrapped(json.at("headline").get<std::string>()) + "\n\n");
  report.show(claim_columns().table(json.at("claims").get<std::vector<Json>>(), "claims", layout.in_full()));
  if (!options.only.empty()) report.say(claims_text(judged, layout));
  if (!ledger.empty()) {
    report.files().write(ledger, json_text(json));
    report.files().write(fs::path(ledger).replace_extension(".md"), ledger_markdown(json));
    report.say(fmt::format("\nledger in {}\n", ledger.string()));
  } else {
    report.say("\nno ledger is written of single claims without --ledger FILE\n");
  }
  for (const ThesisRun& run : runs)
    for (const std::string& problem : run.unmet)
      report.fault(fmt::format("{}: {}", run.name, problem), kUnexpectedOutcome);
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> claim_tables() {
  return {claim_columns().described()};
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
      "file of the ledger, with a Markdown table next to it (default: OUT/claims.json; with --only, no ledger)");
  command.flag("--rerun", options.rerun, "repeat all runs, also those whose results are current");
  add_jobs(command, options.jobs);
  add_table(command, options.output);
  command.add("--choices <file.csv>", options.readings,
              "judge all claims again under other assumptions: one set of assumptions per row, one column per changed "
              "assumption, such as results/reference/readings.csv");
  command.footer(
      "Files: claims.json and claims.md (the ledger: claim, published and measured value, verdict) and the runs in "
      "OUT/thesis. With --choices and a ledger also robustness.csv and robustness.json next to it.\n\n"
      "Earlier results: runs of the same scenario by the same build are used again; a ledger is replaced.\n\n"
      "Time: about 5 minutes on two processors; a single claim takes seconds to a minute. With --choices much longer: "
      "each row repeats the experiments.\n\n"
      "Exit status: 0 whatever the verdicts are; 3 if a run did not end as its scenario expects; 130 stopped by "
      "Ctrl-C.");
}

}  // namespace hapbench
