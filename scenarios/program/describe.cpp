#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "device_model/device_presets.hpp"
#include "device_model/theory/stiffness_limits.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/study.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "scenarios/thesis_claims/choices.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Appends the card of a parameter to the model's.
void add_parameter(Description& d, const std::string& path, const char* unit, const char* meaning) {
  const FieldGuide& field = *find_field(path);
  const std::string initial = default_text(field), range = field.value.allowed;
  d.text += card({.name = path, .initial = initial, .allowed = range, .meaning = meaning}, 4);
  d.json["parameters"].push_back(
      {{"name", path}, {"unit", unit}, {"default", initial}, {"range", range}, {"meaning", meaning}});
}

Description describe_model(const char* kind, const ModelInfo& info, std::span<const OwnParameter> own = {},
                           const AlgorithmOrigin& origin = {}) {
  Description d;
  d.text = fmt::format("{} {}\n{}\n", kind, bold(stdout, info.name), wrapped(info.summary));
  for (const auto& [title, text] : {std::pair{"formula", info.formula}, std::pair{"source", info.source},
                                    std::pair{"known failure", info.known_failure}})
    d.text += entry(title, text, 2, 17);
  d.json = {{"kind", kind},
            {"name", info.name},
            {"summary", info.summary},
            {"formula", info.formula},
            {"source", info.source},
            {"known_failure", info.known_failure},
            {"parameters", Json::array()}};
  if (!origin.file.empty()) {
    d.text += entry("plugin", fmt::format("{}, hash {}", origin.file, origin.hash), 2, 17);
    d.json["plugin"] = {{"file", origin.file}, {"hash", origin.hash}};
  }
  if (!info.parameters.empty() || !own.empty()) d.text += "\n  parameters\n";
  for (const auto& [parameter, meaning] : info.parameters)
    add_parameter(d, parameter.field, parameter.range.unit, meaning);
  for (const OwnParameter& parameter : own) {
    add_parameter(d, fmt::format("rendering.parameters.{}.{}", info.name, parameter.name), parameter.range.unit,
                  parameter.meaning);
  }
  return d;
}

/// A field whose value is a function of time, from which `describe profile` takes its schema.
constexpr const char* kSomeProfile = "motion.orientation.tilt_rad";

const ModelInfo* find_stage(const std::string& name) {
  for (const ModelInfo* stage : stages()) {
    if (stage->name == name) return stage;
  }
  return nullptr;
}

/// Appends a line "time.steps=2000" for each value in a scenario's text.
void add_assignments(std::string& text, const std::string& path, const Json& value) {
  if (!value.is_object()) {
    text += wrapped(fmt::format("{}={}", path, shown(value)), 6).erase(4, 2);
    return;
  }
  for (const auto& field : value.items()) {
    if (field.key() == "$schema" || field.key() == "description" || field.key() == "source") continue;
    add_assignments(text, path.empty() ? field.key() : path + "." + field.key(), field.value());
  }
}

Description describe_scenario(const std::filesystem::path& file) {
  const ScenarioText given = read_scenario_text(file);
  const LoadedScenario loaded = load_scenario(given, {});
  const Scenario& scenario = loaded.scenario;
  std::string text = fmt::format("scenario {}\n", bold(stdout, scenario.name));
  if (!scenario.description.empty()) text += wrapped(scenario.description);
  text += fmt::format("\n  file    {}\n", file.string());  // whole, to be copied
  if (!scenario.source.empty()) text += entry("source", scenario.source, 2, 10);
  text += "\n  set (\"hapbench describe scenario\" explains the fields, --json has all with their defaults)\n";
  add_assignments(text, "", given.json);
  return {text, effective_scenario(scenario, scenario.directory)};
}

Description describe_profile() {
  FieldGuide profile = *find_field(kSomeProfile);
  profile.meaning = "a function of time: a number that does not change, or an object";
  profile.presence = Presence::no_default;
  return {fields_text("profile", profile), profile.schema()};
}

/// Shows the numbers of a published device, each with its source.
Description describe_preset(const DevicePreset& preset) {
  Description d;
  d.text = fmt::format("preset {}: {}\n{}", bold(stdout, preset.name), preset.device,
                       wrapped("of device.type \"impedance\": \"device\": {\"type\": \"impedance\", \"preset\": \"" +
                               std::string(preset.name) + "\"}; fields beside it override its numbers")) +
           "\n";
  d.json = {{"kind", "preset"}, {"name", preset.name}, {"device", preset.device}, {"numbers", Json::object()}};
  const std::tuple<const char*, SourcedNumber, const char*> numbers[] = {
      {"handle_mass_kg", preset.handle_mass, ""},
      {"viscous_N_s_per_m", preset.viscous, ""},
      {"coulomb_N", preset.coulomb, ""},
      {"encoder_step_m", preset.encoder_step, ""},
      {"force_max_N", preset.force_max, ""},
      {"delay_samples", {config_of(preset).delay_samples, NumberSource::ours}, "none is published; "},
      {"max_stiffness_N_per_m", preset.max_stiffness, "published largest stable stiffness; "},
      {"max_damping_N_s_per_m", preset.max_damping, "published largest stable damping; "}};
  for (const auto& [name, number, meaning] : numbers) {
    const std::string range =
        number.low < number.high ? fmt::format(", may be {:.3g} to {:.3g}", number.low, number.high) : "";
    d.text += entry(fmt::format("{} {:g}", name, number.value), meaning + (source_text(number.source) + range), 2, 32);
    d.json["numbers"][name] = {
        {"value", number.value}, {"source", source_text(number.source)}, {"low", number.low}, {"high", number.high}};
  }
  return d;
}

/// The command that a study stands for, and its file as it is.
Description describe_study(const BundledStudy& study) {
  const std::string text = read_text_file(study.file, kLargestJsonFile);
  return {fmt::format("study {}\n{}\n{}\n{}\n  asked by: hapbench {} {}\n", bold(stdout, study.name),
                      wrapped(study.summary), study.file.string(), text, study.ask, study.name),
          {{"kind", "study"}, {"name", study.name}, {"file", study.file.string()}, {"study", parse_json(text)}}};
}

/// Explains how runs are judged to be stable, and what is known in theory.
Description describe_stability() {
  Description d;
  d.json = {{"kind", "stability"}};
  std::string limits;
  for (const StiffnessLimit& limit : stiffness_limits()) {
    limits += fmt::format("  {}\n{}", limit.name, entry("formula", limit.formula, 4, 10));
    limits += entry("for", limit.applies, 4, 10) + entry("source", limit.source, 4, 10);
    d.json["limits"].push_back(
        {{"name", limit.name}, {"formula", limit.formula}, {"applies", limit.applies}, {"source", limit.source}});
  }
  d.text = "stability\n" +
           wrapped(
               "A run is judged by its motion, quarter by quarter; the amplitude is the largest speed. One that is too "
               "short to tell is made up to 64 times as long.") +
           "\n";
  for (auto motion = kMotionClasses.rbegin(); motion != kMotionClasses.rend(); ++motion)  // "all else" last
    d.text += entry(motion_class_name(*motion), text_of(*motion).rule, 2, 13);
  for (
      const char* paragraph :
      {"Limits count stable and dying out as stable: the tool comes to rest if the run goes on. A run that goes through "
       "the surface, loses contact, is stuck or never touches (describe outcomes) has a class of its own and is not "
       "stable, however calm it is.",
       "The analytic limit, under leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M = 0 with lambda = lambda_max(S), is "
       "given where the tool is alone with springs that stay in contact and the force is -K S p. Under "
       "velocity_verlet and rk4 it is that of the eigenvalues of a step; the implicit integrators have none. With a "
       "device in the loop it is where the first eigenvalue of the loop of hand, handle and wall leaves the unit "
       "circle, as long as nothing saturates and the contact lasts. With --stable bounded the edge by bisection is that of "
       "\"diverged\"."})
    d.text += "\n" + wrapped(paragraph);
  d.text += "\nlimits of the stiffness K of a wall on an impedance device\n";
  d.text += wrapped(
      "b is the handle's damping, c its Coulomb friction, q the encoder's step, m the moving mass, T the period, t_d = d T "
      "the delay. Each is written beside the edge where it applies.");
  d.text += limits;
  return d;
}

/// The rules by which `run` says what is wrong.
Description describe_diagnosis() {
  Description d{"rules of the diagnosis, which run prints and writes to summary.json\n\n", Json::array()};
  for (const DiagnosisRule& rule : diagnosis_rules()) {
    const std::string unit = std::string_view(rule.unit) == "1" ? "" : std::string(" ") + rule.unit;
    d.text += entry(rule.name, fmt::format("{} > {:g}{}", rule.number, rule.threshold, unit), 2, 14);
    d.json.push_back(
        {{"rule", rule.name}, {"number", rule.number}, {"unit", rule.unit}, {"threshold", rule.threshold}});
  }
  return d;
}

/// Names that stand for no single thing of a list.
constexpr struct {
  const char* name;
  Description (*describe)();
} kSections[] = {{"choices_schema",
                  [] {
                    return Description{"", choices_schema()};
                  }},
                 {"diagnosis", describe_diagnosis},
                 {"profile", describe_profile},
                 {"scenario",
                  [] {
                    return Description{fields_text("scenario", scenario_guide()), scenario_guide().schema};
                  }},
                 {"schema",
                  [] {
                    return Description{"", scenario_schema()};
                  }},
                 {"stability", describe_stability}};

}  // namespace

std::vector<std::string> described_names() {
  std::vector<std::string> names;
  for (const auto& section : kSections) names.emplace_back(section.name);
  for (const AlgorithmEntry& entry : algorithms()) names.emplace_back(entry.info->name);
  for (const DepthModelEntry& entry : depth_models()) names.emplace_back(entry.info->name);
  for (const ModelInfo* stage : stages()) names.emplace_back(stage->name);
  for (const IntegratorEntry* entry : kIntegrators) names.emplace_back(entry->info.name);
  for (const char* field : {"environment", "tool", "hand", "device", kSomeProfile}) {
    for (const std::string& name : type_names(field)) names.push_back(name);
  }
  for (const DevicePreset& preset : device_presets()) names.emplace_back(preset.name);
  for (const BundledScenario& bundled : bundled_scenarios()) names.push_back(bundled.name);
  for (const BundledStudy& study : bundled_studies()) names.push_back(study.name);
  for (const std::string& name : result_names()) names.push_back(name);
  for (const std::string& name : described_words()) names.push_back(name);
  for (const Claim& claim : all_claims()) names.emplace_back(claim.id);
  for (const std::string& choice : choice_names()) names.push_back(choice);
  for (const std::string& path : scenario_field_paths()) names.push_back(path);
  return names;
}

namespace {

Description joined(const std::vector<Description>& meanings) {
  if (meanings.size() == 1) return meanings.front();
  Description all;
  all.json = Json::array();
  for (const Description& meaning : meanings) {
    all.text += (all.text.empty() ? "" : "\n") + meaning.text;
    all.json.push_back(meaning.json);
  }
  return all;
}

/// Explains the field at that path, once for each group of types that share it.
std::vector<Description> describe_field(const std::string& path) {
  if (const std::string values = types_text(path); !values.empty())
    return {{values, {{"field", path}, {"types", type_names(path.substr(0, path.rfind('.')))}}}};
  std::vector<Description> meanings;
  for (const auto& [types, field] : typed_fields(path)) {
    Json json = field->schema();
    if (!types.empty()) json["of"] = types;
    meanings.push_back({fields_text(path, *field, types), std::move(json)});
  }
  return meanings;
}

/// Explains the fields of that name in any section: "torque" for record.torque.
std::vector<Description> describe_fields_called(const std::string& name) {
  std::vector<Description> meanings;
  for (const std::string& path : scenario_field_paths()) {
    if (!path.ends_with("." + name)) continue;
    for (Description& field : describe_field(path)) meanings.push_back(std::move(field));
  }
  return meanings;
}

Description describe_name(const std::string& name) {
  std::vector<Description> meanings;
  const auto add = [&meanings](Description more) { meanings.push_back(std::move(more)); };
  // A name may mean two things: normal_projection is an algorithm and a depth model.
  if (const AlgorithmEntry* entry = find_algorithm(name))
    add(describe_model("algorithm", *entry->info, entry->own_parameters, entry->origin));
  if (const DepthModelEntry* entry = find_depth_model(name)) add(describe_model("depth model", *entry->info));
  if (const ModelInfo* stage = find_stage(name)) add(describe_model("stage", *stage));
  if (const IntegratorEntry* entry = find_integrator(name)) add(describe_model("integrator", entry->info));
  if (const DevicePreset* preset = find_device_preset(name)) add(describe_preset(*preset));
  if (name == "algorithm") {
    for (Description& field : describe_field("rendering.algorithm")) add(std::move(field));
    meanings.back().text += wrapped("\"hapbench list algorithms\" shows them with what they do");
  }
  for (Description& result : describe_results(name)) add(std::move(result));
  const std::vector<Description> fields = describe_field(name);
  for (const Description& field : fields) add(field);
  for (const auto& section : kSections) {
    if (name == section.name) add(section.describe());
  }
  if (fields.empty()) {
    const auto types = types_called(name);
    for (const auto& [field, type] : types)
      add({fields_text(name, *type, types.size() > 1 ? field : ""), type->schema});
  }
  for (Description& word : describe_word(name)) add(std::move(word));
  if (meanings.empty()) meanings = describe_heading(name);
  if (meanings.empty()) meanings = describe_thesis(name);
  if (meanings.empty()) meanings = describe_choice(name);
  if (meanings.empty()) meanings = describe_fields_called(name);
  if (!meanings.empty()) return joined(meanings);
  for (const BundledScenario& bundled : bundled_scenarios()) {
    if (bundled.name == name) return describe_scenario(bundled.file);
  }
  for (const BundledStudy& study : bundled_studies()) {
    if (study.name == name) return describe_study(study);
  }
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) return describe_scenario(find_scenario(name));
  throw InputError(
      fmt::format("nothing is called \"{}\"{}; \"hapbench list\" shows the names, \"hapbench describe scenario\" "
                  "the fields of a scenario file",
                  name, nearest_name_hint(name, described_names())));
}

struct DescribeOptions {
  std::string name;
  OutputOptions output;
};

int describe(const DescribeOptions& options) {
  const Description d = describe_name(options.name);
  OutputOptions output = options.output;
  output.json |= d.text.empty();
  print(output, d.text, d.json);
  return kSuccess;
}

}  // namespace

void add_describe(CommandLine& line) {
  auto [command, options] = line.command(
      "describe",
      "Explain an algorithm, a depth model, an integrator, an environment, a field, a scenario, a metric, a column or "
      "file of the results, a word or heading that the program prints, a claim, a choice on record or a place of the thesis",
      describe);
  command
      .add(
          "name", options.name,
          "a name that \"list\" shows, a field such as rendering.limits, \"scenario\" (all fields), \"schema\", "
          "\"choices_schema\", \"stability\", \"diagnosis\"; a metric or a column, \"metrics\" or \"columns\" for all of them, a "
          "heading such as \">30Hz rms N\", or a file such as trajectory.csv; a claim such as C5, a choice such as "
          "planar.first_tilt or a place such as \"Fig. A.2\"")
      .required();
  add_output_options(command, options.output);
}

}  // namespace hapbench
