#include "scenarios/program/describe/models.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <span>
#include <string>
#include <tuple>

#include "algorithms/registry.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/program/describe/fields.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

Json model_json(const char* kind, const ModelInfo& info, std::span<const AlgorithmParameter> own,
                const AlgorithmOrigin& origin) {
  Json parameters = Json::array();
  const auto add = [&parameters](const std::string& path, const char* unit, const char* meaning) {
    const FieldGuide& field = *find_field(path);
    const Json& initial = field.initial;
    const std::string given = initial.is_number_float() ? fmt::format("{:g}", initial.get<double>()) : initial.dump();
    parameters.push_back({{"name", path},
                          {"unit", unit},
                          {"default", field.presence == Presence::has_default ? given : "see meaning"},
                          {"range", field.value.allowed},
                          {"meaning", meaning}});
  };
  for (const auto& [parameter, meaning] : info.parameters) add(parameter.field, parameter.range.unit, meaning);
  for (const AlgorithmParameter& p : own)
    add(fmt::format("rendering.parameters.{}.{}", info.name, p.name), p.range.unit, p.meaning);
  Json json = {{"kind", kind},
               {"name", info.name},
               {"summary", info.summary},
               {"formula", info.formula},
               {"source", info.source},
               {"known_failure", info.known_failure},
               {"parameters", std::move(parameters)}};
  if (!origin.file.empty()) json["plugin"] = {{"file", origin.file}, {"hash", origin.hash}};
  return json;
}

Description describe_preset(const DevicePreset& preset, const Layout& layout) {
  Description d;
  d.text = fmt::format("preset {}: {}\n{}", bold(stdout, preset.name), preset.device,
                       layout.wrapped("use it in a scenario with \"device\": {\"type\": \"impedance\", \"preset\": \"" +
                                      std::string(preset.name) +
                                      "\"}; other fields of \"device\" replace the preset's values")) +
           "\n";
  d.json = {{"kind", "preset"}, {"name", preset.name}, {"device", preset.device}, {"numbers", Json::object()}};
  const std::tuple<const char*, SourcedNumber, const char*> numbers[] = {
      {"handle_mass_kg", preset.handle_mass, ""},
      {"viscous_N_s_per_m", preset.viscous, ""},
      {"coulomb_N", preset.coulomb, ""},
      {"encoder_step_m", preset.encoder_step, ""},
      {"force_max_N", preset.force_max, ""},
      {"delay_samples", {config_of(preset).delay_samples, kOurEstimate}, "no value is published; "},
      {"max_stiffness_N_per_m", preset.max_stiffness, "largest stable stiffness, as published; "},
      {"max_damping_N_s_per_m", preset.max_damping, "largest stable damping, as published; "}};
  for (const auto& [name, number, meaning] : numbers) {
    const std::string range =
        number.low < number.high ? fmt::format(", plausible range {:.3g} to {:.3g}", number.low, number.high) : "";
    d.text +=
        layout.entry(fmt::format("{} {:g}", name, number.value), meaning + (std::string(number.source) + range), 2, 32);
    d.json["numbers"][name] = {
        {"value", number.value}, {"source", number.source}, {"low", number.low}, {"high", number.high}};
  }
  return d;
}

}  // namespace

void add_models(Index& index, const Layout& layout) {
  const auto add = [&index, &layout](const char* kind, const ModelInfo& info,
                                     std::span<const AlgorithmParameter> own = {}, const AlgorithmOrigin& origin = {}) {
    index.push_back({kind, info.name, info.summary,
                     [=, &info] { return entry_description(model_json(kind, info, own, origin), layout); }});
  };
  for (const AlgorithmEntry& entry : algorithms())
    add("algorithm", *entry.info, entry.algorithm_parameters, entry.origin);
  for (const DepthModelEntry& entry : depth_models()) add("depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add("stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add("integrator", entry->info);
}

void add_presets(Index& index, const Layout& layout) {
  for (const DevicePreset& preset : device_presets())
    index.push_back(
        {"preset", preset.name, preset.device, [&preset, layout] { return describe_preset(preset, layout); }});
}

Description describe_stability(const Layout& layout) {
  Description d;
  d.json = {{"kind", "stability"}};
  for (const StiffnessLimit& limit : stiffness_limits())
    d.json["limits"].push_back(
        {{"name", limit.name}, {"formula", limit.formula}, {"applies", limit.applies}, {"source", limit.source}});
  d.text = "stability\n";
  d.text += layout.wrapped(
      "Stability is judged from the motion of a run: the amplitude (largest speed) in each quarter of the run is "
      "compared. A run that is too short for a decision is extended to up to 64 times its length.\n\n");
  for (std::size_t i = kMotionClasses; i-- > 0;)  // "all else" last
    d.text += layout.entry(run_verdict_texts()[i].name, run_verdict_texts()[i].rule, 2, 13);
  d.text +=
      "\n" +
      layout.wrapped(
          "`limit` counts the classes stable and decaying as stable: the tool is at rest, or comes to rest if the run "
          "goes on. With --stable bounded, it also counts the class vibrating. A run that passes through the surface, "
          "loses contact, gets stuck or never touches has a class of its own, with the name of its outcome (describe "
          "outcome). It is never stable, even if it does not vibrate.\n\nIf a script moves the tool, the tool may "
          "never come to rest. `limit` and `tune` then judge the vibration of the handle after the first quarter of "
          "the contact time: stable means at most 1 mm/s rms above 30 Hz, and that bounces stop or become lower "
          "(--stable still). With --stable settled, they judge the classes above, and only motion above 30 Hz and "
          "faster than 1 mm/s counts.\n\n`limit` prints the simulated limit, found by "
          "bisection on runs, beside the linear limit, which follows from eigenvalues. For contact that cannot be lost "
          "(bilateral springs), the linear limit is also called theoretical limit.\n\nA tool without a device on "
          "bilateral springs has the force -K S p. With leapfrog, its theoretical limit satisfies 4 - 2 lambda B dt / "
          "M - lambda K dt^2 / M = 0 with lambda = lambda_max(S). With velocity_verlet and rk4, the theoretical limit "
          "follows from the eigenvalues of one step. The implicit integrators have no limit.\n\nWith a device or a "
          "surface, the linear limit is the value at which the first eigenvalue of the loop of hand, device and "
          "contact leaves the unit circle. It holds while nothing saturates and the contact lasts.");
  d.text += "\nformulas for the largest stiffness K of a wall on an impedance device\n";
  d.text += layout.wrapped(
      "Symbols: b damping of the handle, c its Coulomb friction, q encoder step, m moving mass, T time step, d delay "
      "in time steps, t_d = d T delay in seconds, B damping of the wall. limit.csv has a column for each formula, with "
      "a value where the formula applies.");
  for (const Json& limit : d.json["limits"]) d.text += entry_text(limit, layout, 2);
  return d;
}

Description describe_diagnosis(const Layout& layout) {
  Description d{
      layout.wrapped(
          fmt::format("Rules of the diagnosis. `run` prints each rule whose number exceeds its threshold, and "
                      "writes it to summary.json. `tune` recommends no run to which one of the rules {} "
                      "applies and, unless --allow-vibration is given, none to which {} applies.",
                      rule_names(RuleKind::failure), rule_names(RuleKind::low_vibration)),
          0) +
          "\n",
      Json::array()};
  for (const Diagnosed& rule : diagnosis_rules()) {
    d.text += layout.entry(rule.rule,
                           fmt::format("{}; threshold {}", rule.number, with_unit(rule.threshold, rule.unit)), 2, 14);
    d.json.push_back({{"rule", rule.rule},
                      {"number", rule.number},
                      {"unit", rule.unit},
                      {"threshold", rule.threshold},
                      {"kind", rule_kind_name(rule_kind(rule.rule))},
                      {"says", rule.says}});
  }
  return d;
}

}  // namespace hapbench
