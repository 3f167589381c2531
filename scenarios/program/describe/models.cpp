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

Json model_json(const char* kind, const ModelInfo& info, std::span<const OwnParameter> own,
                const AlgorithmOrigin& origin) {
  Json parameters = Json::array();
  const auto add = [&parameters](const std::string& path, const char* unit, const char* meaning) {
    const FieldGuide& field = *find_field(path);
    const Json& initial = field.initial;
    const std::string given = initial.is_number_float() ? fmt::format("{:g}", initial.get<double>()) : initial.dump();
    parameters.push_back({{"name", path},
                          {"unit", unit},
                          {"default", field.presence == Presence::has_default ? given : "by scene"},
                          {"range", field.value.allowed},
                          {"meaning", meaning}});
  };
  for (const auto& [parameter, meaning] : info.parameters) add(parameter.field, parameter.range.unit, meaning);
  for (const OwnParameter& p : own)
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
  d.text =
      fmt::format("preset {}: {}\n{}", bold(stdout, preset.name), preset.device,
                  layout.wrapped("of device.type \"impedance\": \"device\": {\"type\": \"impedance\", \"preset\": \"" +
                                 std::string(preset.name) + "\"}; fields next to it override its numbers")) +
      "\n";
  d.json = {{"kind", "preset"}, {"name", preset.name}, {"device", preset.device}, {"numbers", Json::object()}};
  const std::tuple<const char*, SourcedNumber, const char*> numbers[] = {
      {"handle_mass_kg", preset.handle_mass, ""},
      {"viscous_N_s_per_m", preset.viscous, ""},
      {"coulomb_N", preset.coulomb, ""},
      {"encoder_step_m", preset.encoder_step, ""},
      {"force_max_N", preset.force_max, ""},
      {"delay_samples", {config_of(preset).delay_samples, kOurEstimate}, "none is published; "},
      {"max_stiffness_N_per_m", preset.max_stiffness, "published largest stable stiffness; "},
      {"max_damping_N_s_per_m", preset.max_damping, "published largest stable damping; "}};
  for (const auto& [name, number, meaning] : numbers) {
    const std::string range =
        number.low < number.high ? fmt::format(", may be {:.3g} to {:.3g}", number.low, number.high) : "";
    d.text +=
        layout.entry(fmt::format("{} {:g}", name, number.value), meaning + (std::string(number.source) + range), 2, 32);
    d.json["numbers"][name] = {
        {"value", number.value}, {"source", number.source}, {"low", number.low}, {"high", number.high}};
  }
  return d;
}

}  // namespace

void add_models(Index& index, const Layout& layout) {
  const auto add = [&index, &layout](const char* kind, const ModelInfo& info, std::span<const OwnParameter> own = {},
                                     const AlgorithmOrigin& origin = {}) {
    index.push_back({kind, info.name, info.summary,
                     [=, &info] { return thing_description(model_json(kind, info, own, origin), layout); }});
  };
  for (const AlgorithmEntry& entry : algorithms()) add("algorithm", *entry.info, entry.own_parameters, entry.origin);
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
      "A run is judged by its motion, quarter by quarter; the amplitude is the largest speed. One that is too short to "
      "tell is made up to 64 times as long.\n\n");
  for (std::size_t i = kMotionClasses; i-- > 0;)  // "all else" last
    d.text += layout.entry(run_verdict_texts()[i].name, run_verdict_texts()[i].rule, 2, 13);
  d.text +=
      "\n" +
      layout.wrapped(
          "Limits count stable and dying out as stable: the tool comes to rest if the run goes on. A run that goes "
          "through the surface, loses contact, is stuck or never touches (describe outcomes) has a class of its own "
          "and is not stable, however calm it is.\n\n"
          "The analytic limit, under leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M = 0 with lambda = "
          "lambda_max(S), is given where the tool is alone with springs that stay in contact and the force is -K S "
          "p. Under velocity_verlet and rk4 it is that of the eigenvalues of a step; the implicit integrators have "
          "none. With a device in the loop it is where the first eigenvalue of the loop of hand, handle and wall "
          "leaves the unit circle, as long as nothing saturates and the contact lasts. With --stable bounded the "
          "edge by bisection is that of \"diverged\".");
  d.text += "\nlimits of the stiffness K of a wall on an impedance device\n";
  d.text += layout.wrapped(
      "b is the handle's damping, c its Coulomb friction, q the encoder's step, m the moving mass, T the period, t_d "
      "= d T the delay. Each is written beside the edge where it applies.");
  for (const Json& limit : d.json["limits"]) d.text += thing_text(limit, layout, 2);
  return d;
}

Description describe_diagnosis(const Layout& layout) {
  Description d{"rules of the diagnosis, which run prints and writes to summary.json\n\n", Json::array()};
  for (const Diagnosed& rule : diagnosis_rules()) {
    const std::string unit = rule.unit == "1" ? "" : " " + rule.unit;
    d.text += layout.entry(rule.rule, fmt::format("{} > {:g}{}", rule.number, rule.threshold, unit), 2, 14);
    d.json.push_back(
        {{"rule", rule.rule}, {"number", rule.number}, {"unit", rule.unit}, {"threshold", rule.threshold}});
  }
  return d;
}

}  // namespace hapbench
