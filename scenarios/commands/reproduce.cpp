#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/commands/command.hpp"
#include "scenarios/commands/table.hpp"
#include "scenarios/config/load_scenario.hpp"
#include "scenarios/experiments/claims/claims.hpp"
#include "scenarios/files/json_file.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
  std::vector<std::string> only;
  std::string out = (fs::path("results") / "out" / "reproduce").string();
  std::string ledger;
  bool no_cache = false;
  bool anew = false;
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
  for (const std::string& id : ids) {
    if (std::find(valid.begin(), valid.end(), id) != valid.end()) continue;
    throw InputError(
        fmt::format("--only: got \"{}\"; allowed: {}{}", id, quoted_list(valid), nearest_name_hint(id, valid)));
  }
  std::erase_if(claims, [&ids](const Claim& c) { return std::find(ids.begin(), ids.end(), c.id) == ids.end(); });
  return claims;
}

/// True when the directory holds the results of this very scenario from this very program.
bool is_current(const fs::path& directory, const Scenario& scenario) {
  try {
    const Json summary = parse_json(read_text_file(directory / "summary.json", kLargestJsonFile));
    const Json& made = summary.at("provenance");
    return made.at("scenario_hash") == scenario_hash(scenario) && made.at("commit") == provenance().commit &&
           !provenance().commit.ends_with("-dirty");
  } catch (const std::exception&) {
    return false;  // missing, damaged or of another version: run it
  }
}

/// Runs the thesis's scenarios, those apart whose results are current. Returns how many did not end as expected.
std::size_t run_thesis(const ReproduceOptions& options, const ShellCache& cache) {
  std::size_t unmet = 0;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    if (bundled.group != "thesis") continue;
    const LoadedScenario loaded = load_scenario(bundled.file);
    const fs::path directory = fs::path(options.out) / "thesis" / bundled.name;
    if (!options.anew && is_current(directory, loaded.scenario)) continue;
    const RunReport report = run_scenario(loaded, directory, !options.output.quiet, cache);
    for (const std::string& problem : report.unmet) fmt::print(stderr, "hapbench: {}: {}\n", bundled.name, problem);
    if (!report.unmet.empty()) ++unmet;
  }
  return unmet;
}

Json ledger_json(const std::vector<Judged>& judged) {
  Json claims = Json::array();
  for (const Judged& j : judged) {
    claims.push_back({{"id", j.claim.id},
                      {"place", j.claim.place},
                      {"claim", j.claim.claim},
                      {"published", j.claim.published},
                      {"measured", j.finding.measured},
                      {"rule", j.claim.rule},
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
  const std::size_t unmet = run_thesis(options, cache);

  const Evidence evidence{published, ResultFiles(fs::path(options.out) / "thesis"), cache};
  std::vector<Judged> judged;
  Table table({{"id", false}, {"verdict", false}, {"measured", false}});
  for (const Claim& claim : claims) {
    judged.push_back({claim, claim.judge(evidence)});
    table.add({claim.id, std::string(verdict_name(judged.back().finding.verdict)), judged.back().finding.measured});
  }
  const Json json = ledger_json(judged);
  const fs::path ledger = options.ledger.empty() ? fs::path(options.out) / "claims.json" : fs::path(options.ledger);
  write_file_atomically(ledger, json_text(json));
  write_file_atomically(fs::path(ledger).replace_extension(".md"), ledger_markdown(judged));
  print(options.output, table.text() + fmt::format("\nledger in {}\n", ledger.string()), json);
  return unmet == 0 ? kSuccess : kUnexpectedOutcome;
}

}  // namespace

void add_reproduce(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand("reproduce", "Run the thesis's experiments and judge its claims");
  command->add_option("--only", options->only, "ids of claims, separated by commas")->delimiter(',');
  command->add_option("--out", options->out, "directory of the results (default: results/out/reproduce)");
  command->add_option("--ledger", options->ledger,
                      "the ledger, JSON; a Markdown table beside it (default: OUT/claims.json)");
  command->add_flag("--anew", options->anew, "run every scenario, current results or not");
  add_cache_option(*command, options->no_cache);
  add_output_options(*command, options->output);
  command->callback([options, &chosen] { chosen = [options] { return reproduce(*options); }; });
}

}  // namespace hapbench
