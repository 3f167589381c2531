#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/studies/explanation/rules.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ExplainOptions {
  std::vector<std::string> runs;
  bool rules = false;
  OutputOptions output;
};

Json rule_json(const ExplainRule& rule) {
  return {{"rule", rule.name}, {"number", rule.number}, {"unit", rule.unit}, {"threshold", rule.threshold}};
}

int print_rules(const OutputOptions& output) {
  std::string text;
  Json json = Json::array();
  for (const ExplainRule& rule : explain_rules()) {
    text += entry(rule.name,
                  fmt::format("{} > {:g}{}", rule.number, rule.threshold,
                              std::string_view(rule.unit) == "1" ? "" : std::string(" ") + rule.unit),
                  0, 12);
    json.push_back(rule_json(rule));
  }
  print(output, text, json);
  return kSuccess;
}

int explain(const ExplainOptions& options) {
  if (options.rules) return print_rules(options.output);
  if (options.runs.empty()) throw InputError("explain: got no run; allowed: folders of runs, or --rules");
  std::string text;
  Json all = Json::array();
  for (const std::string& folder : options.runs) {
    const RunFiles run = read_run(folder);
    const std::vector<Explanation> findings = explained(run);
    if (options.runs.size() > 1) text += bold(stdout, folder) + "\n";
    if (findings.empty()) text += fmt::format("nothing is wrong by {} rules\n", explain_rules().size());
    Json json = Json::array();
    for (const Explanation& finding : findings) {
      const ExplainRule& rule = *finding.rule;
      text += wrapped(fmt::format("{} (rule {}: above {:g})", finding.says, rule.name, rule.threshold), 0) +
              wrapped(fmt::format("try: {}", rule.attempt), 2);
      Json& row = json.emplace_back(rule_json(rule));
      row["value"] = finding.value;
      row["says"] = finding.says;
      row["try"] = rule.attempt;
    }
    all.push_back({{"run", folder}, {"outcome", run.outcome}, {"findings", std::move(json)}});
  }
  print(options.output, text, all);
  return kSuccess;
}

}  // namespace

void add_explain(CommandLine& line) {
  auto [command, options] = line.command("explain", "Say what is wrong with a run, and what to try", explain);
  command.add("runs", options.runs, "folders of runs");
  command.flag("--rules", options.rules, "list the rules, each with its number and threshold");
  add_output_options(command, options.output);
  command.footer(
      "Reads summary.json, scenario.effective.json and, where they are, trajectory.csv and timing.json. Every statement is that of a "
      "rule whose number is above its threshold; where nothing is wrong, it says nothing else.");
}

}  // namespace hapbench
