#include "scenarios/program/tune/json.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "results/io/columns.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/tune/columns.hpp"

namespace hapbench {
namespace {

Json law_json(const TuneQuestion& question, const TunedLaw& law) {
  Json json = tuned_columns(question).json(law);
  for (const Margin& margin : kMargins) json["margins"][margin.key] = cell_json(cell_of(law.margins.*margin.of));
  json["metrics"] = law.choice ? law.choice->metrics : MetricValues();
  json["error"] = law.error;
  json["linear_limit_N_per_m"] = law.choice ? cell_json(cell_of(law.limits.known_linear_limit())) : Json();
  json["simulated_limit_N_per_m"] = law.choice ? cell_json(cell_of(law.limits.end.value)) : Json();
  return json;
}

Json limits_json(const TuneQuestion& question) {
  Json limits = {{"margin", question.margin}, {"low_vibration", !question.allow_vibration}};
  limits.update(bounds_json(question));
  return limits;
}

}  // namespace

Json tuning_json(const Tuning& tuning, const std::filesystem::path& tuned) {
  Json laws = Json::array();
  for (const TunedLaw& law : tuning.laws) laws.push_back(law_json(tuning.question, law));
  const auto name_of = [&](std::size_t rank) {
    return rank < tuning.ranking.size() ? Json(tuning.ranking[rank]->algorithm) : Json();
  };
  return {{"algorithms", std::move(laws)},
          {"recommended", name_of(0)},
          {"runner_up", name_of(1)},
          {"limits", limits_json(tuning.question)},
          {"scenario", tuned.empty() ? Json() : Json(tuned.string())},
          {"runs", tuning.runs}};
}

Json tuned_scenario(const Tuning& tuning, const TunedLaw& law, const std::filesystem::path& out) {
  const Scenario choice = load_scenario(tuning.question.scenario, law.overrides).scenario;
  Json json = effective_scenario(choice, out);
  json["name"] = tuning.question.scenario.file.stem().string() + "_tuned";
  json["description"] = fmt::format("{} tuned by hapbench tune: {}", choice.name, law.algorithm);
  return json;
}

}  // namespace hapbench
