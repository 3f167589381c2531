#include "scenarios/program/assumption_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/thesis/assumption_sets.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "scenarios/thesis/sensitivity.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The verdict on a claim under an assumption set, and the recorded verdict.
struct MovedClaim {
  std::string id, verdict, number, recorded, recorded_number, why;

  bool moved() const { return verdict != recorded; }
};

Columns<MovedClaim> moved_columns() {
  Columns<MovedClaim> columns;
  columns.add({{"claim", "", "id of a claim; \"hapbench describe ID\" explains it", &MovedClaim::id, only_printed()}});
  columns.add({{"verdict", "", "verdict under the assumption set", &MovedClaim::verdict, only_printed()}});
  columns.add({{"number", "", "measured number that decides the verdict, under the assumption set", &MovedClaim::number,
                only_printed()}});
  columns.add({{"moved from", "", "the recorded verdict and number, if the verdict differs from the recorded verdict",
                [](const MovedClaim& c) {
                  return c.moved() ? fmt::format("{}: {}", c.recorded, c.recorded_number) : std::string("-");
                },
                only_printed()}});
  return columns;
}

/// Verdict on a claim under the recorded assumptions, and the robustness of this verdict.
struct DecidedClaim {
  std::string id, verdict, robustness;
};

Columns<DecidedClaim> decided_columns() {
  Columns<DecidedClaim> columns;
  columns.add(
      {{"claim", "", "id of a claim; \"hapbench describe ID\" explains it", &DecidedClaim::id, only_printed()}});
  columns.add({{"verdict", "", "verdict under the recorded assumptions", &DecidedClaim::verdict, only_printed()}});
  columns.add({{"robustness", "", "assumptions for which another plausible value changes the verdict",
                &DecidedClaim::robustness, only_printed()}});
  return columns;
}

/// Returns the entry of each claim in the recorded ledger, claims.json, by the claim's id.
std::map<std::string, Json> ledger_on_record(const fs::path& reference) {
  std::map<std::string, Json> claims;
  const fs::path file = reference / "claims.json";
  with_file(file, [&] {
    const Json ledger = read_json(file);
    for (const Json& claim : ledger.at("claims")) claims[claim.at("id").get<std::string>()] = claim;
    return 0;
  });
  return claims;
}

/// Returns true if an assumption whose value in the set differs from its recorded value can change the verdict on the
/// claim.
bool reaches(const CalibratedSet& calibrated, const Assumptions& assumptions, const Claim& claim,
             const Json& recorded) {
  const auto scenarios = recorded.at("scenarios").get<std::vector<std::string>>();
  for (std::size_t i = 0; i < assumptions.all().size(); ++i) {
    const Assumption& assumption = assumptions.all()[i];
    if (calibrated.set.values[i] != assumption.value && assumption.reaches(scenarios, claim.rule)) return true;
  }
  return false;
}

/// Returns the text about one set: its assumptions, calibrated inputs, and a table of the claims.
std::string set_text(std::size_t number, const CalibratedSet& calibrated, const AssumptionSet& given,
                     const Assumptions& assumptions, const std::vector<MovedClaim>& claims, const Layout& layout) {
  std::string text =
      layout.wrapped(fmt::format("assumption set {}: {}", number, difference_text(given, assumptions))) + "\n";
  std::string inputs;
  for (std::size_t i = 0; i < assumptions.all().size(); ++i) {
    const Assumption& assumption = assumptions.all()[i];
    if (calibrated.missed.contains(i))
      append_item(inputs, assumption.id + ": no value gives the published raw points");
    else if (calibrated.set.values[i] != given.values[i])
      append_item(inputs, fmt::format("{} = {}", assumption.id, calibrated.set.values[i]));
  }
  if (!inputs.empty()) text += layout.wrapped("calibrated anew: " + inputs) + "\n";
  if (claims.empty()) return text + "no claim depends on these assumptions\n";
  text += "\n" + moved_columns().text(claims, layout);
  const auto moved = std::ranges::count_if(claims, &MovedClaim::moved);
  return text + fmt::format("\n{} of {} verdicts differ from the recorded verdicts\n", moved, claims.size());
}

}  // namespace

void report_assumption_sets(const std::vector<Claim>& claims, const fs::path& file, const fs::path& scratch,
                            const CommonOptions& options, Report& report, ProgramContext& context) {
  const fs::path reference = installed_folder("results/reference");
  const Assumptions assumptions(reference / "assumptions.json");
  const PublishedNumbers published(reference / "published.json");
  const std::map<std::string, Json> recorded = ledger_on_record(reference);
  const std::vector<AssumptionSet> sets = read_assumption_sets(file, assumptions);
  // Judge the claims that the assumptions of each set can change.
  std::vector<CalibratedSet> inputs(sets.size());
  std::vector<std::vector<MovedClaim>> judged(sets.size());
  for_each_job(sets.size(), job_options(options, "assumption sets", context), [&](std::size_t i) {
    inputs[i] = calibrated(sets[i], assumptions);
    std::vector<Claim> reached;
    std::ranges::copy_if(claims, std::back_inserter(reached), [&](const Claim& claim) {
      return claim.judge != nullptr && recorded.contains(claim.id) &&
             reaches(inputs[i], assumptions, claim, recorded.at(claim.id));
    });
    const std::vector<SetFinding> found =
        judge_set({assumptions, published}, inputs[i], reached, scratch / std::to_string(i));
    for (std::size_t c = 0; c < reached.size(); ++c) {
      const Json& before = recorded.at(reached[c].id);
      judged[i].push_back({reached[c].id, found[c].verdict, found[c].number, before.at("verdict").get<std::string>(),
                           before.at("number").get<std::string>(), found[c].why});
    }
  });
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  // Report each set.
  Json& json = report.json() = {{"assumption_sets", Json::array()}};
  const Layout layout = context.layout();
  for (std::size_t i = 0; i < sets.size(); ++i) {
    report.add_text((i == 0 ? "" : "\n") + set_text(i + 1, inputs[i], sets[i], assumptions, judged[i], layout));
    Json differing = Json::object(), missed = Json::array(), moved = Json::array();
    for (std::size_t a = 0; a < assumptions.all().size(); ++a) {
      const Assumption& assumption = assumptions.all()[a];
      if (inputs[i].set.values[a] != assumption.value) differing[assumption.id] = inputs[i].set.values[a];
      if (inputs[i].missed.contains(a)) missed.push_back(assumption.id);
    }
    for (const MovedClaim& c : judged[i])
      moved.push_back({{"id", c.id},
                       {"verdict", c.verdict},
                       {"number", c.number},
                       {"why", c.why},
                       {"recorded_verdict", c.recorded},
                       {"recorded_number", c.recorded_number},
                       {"moved", c.moved()}});
    json["assumption_sets"].push_back(
        {{"assumptions", differing}, {"not_calibrated", missed}, {"claims", std::move(moved)}});
  }
}

void record_sensitivity(const std::vector<Claim>& claims, const std::vector<Claim>& all, const fs::path& file,
                        const fs::path& scratch, const CommonOptions& options, Report& report,
                        ProgramContext& context) {
  const fs::path reference = installed_folder("results/reference");
  const Assumptions assumptions(reference / "assumptions.json");
  const PublishedNumbers published(reference / "published.json");
  const JudgingInputs inputs{assumptions, published};
  SensitivityRecord record(file);
  record.keep_only(all);
  // Judge the claims under the recorded assumptions.
  std::vector<Claim> judged;
  std::ranges::copy_if(claims, std::back_inserter(judged),
                       [](const Claim& claim) { return claim.judge != nullptr && !claim.timing; });
  const std::vector<SetFinding> on_record =
      judge_set(inputs, {AssumptionSet{assumptions.recorded_values()}}, judged, scratch / "recorded");
  std::vector<std::vector<std::string>> scenarios;
  std::vector<std::string> reach;
  for (std::size_t c = 0; c < judged.size(); ++c) {
    scenarios.push_back(on_record[c].scenarios);
    reach.push_back(assumptions.reach(scenarios[c], judged[c].rule_texts()));
    record.begin(judged[c].id, reach[c], on_record[c], case_count(assumptions, judged[c], scenarios[c]));
  }
  // Judge the cases that the record lacks, and write the record after each case.
  const std::vector<SensitivityCase> cases = missing_cases(record, assumptions, judged, scenarios);
  std::mutex writing;
  for_each_job(cases.size(), job_options(options, "sensitivity", context), [&](std::size_t i) {
    const Assumption& assumption = assumptions.all()[cases[i].assumption];
    AssumptionSet set{assumptions.recorded_values()};
    set.values[cases[i].assumption] = cases[i].value;
    const std::vector<SetFinding> found =
        judge_set(inputs, calibrated(std::move(set), assumptions), cases[i].claims, scratch / std::to_string(i));
    const std::lock_guard<std::mutex> guard(writing);
    for (std::size_t c = 0; c < found.size(); ++c) {
      record.add(cases[i].claims[c].id, assumption.id, cases[i].value, found[c]);
      if (found[c].verdict == kNotMeasured)
        print_note(context, fmt::format("{} = {}, {}: not measured: {}", assumption.id, cases[i].value,
                                        cases[i].claims[c].id, one_line(found[c].why)));
    }
    FileSet files;
    files.write(file, record.text());
    files.commit();
  });
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  record.sort_cases(assumptions);
  report.files().write(file, record.text());
  // Report the robustness of each verdict.
  std::vector<DecidedClaim> decided;
  Json json = Json::array();
  for (std::size_t c = 0; c < judged.size(); ++c) {
    JudgedClaim claim{judged[c], {Verdict::replicated}, scenarios[c], reach[c]};
    const Robustness robustness = robustness_of(claim, record.entry(judged[c].id, reach[c]));
    decided.push_back({judged[c].id, on_record[c].verdict, robustness.text()});
    json.push_back({{"id", judged[c].id},
                    {"verdict", on_record[c].verdict},
                    {"robustness", robustness.word},
                    {"deciders", robustness.deciders}});
  }
  report.json() = {{"new_cases", cases.size()}, {"claims", std::move(json)}};
  report.add_text(decided_columns().text(decided, context.layout()));
  report.add_text(fmt::format("\n{} new cases; record in {}\n", cases.size(), file.string()));
}

std::vector<DescribedTable> assumption_tables() {
  return {moved_columns().described(), decided_columns().described()};
}

}  // namespace hapbench
