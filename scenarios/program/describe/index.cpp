#include "scenarios/program/describe/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <tuple>

#include "algorithms/registry.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/claims.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// A value in a line: the entries of a list between commas, the members of an object behind their names.
std::string line_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_structured()) return value.is_null() ? "" : value.dump();
  std::string line;
  for (const auto& [key, part] : value.items())
    line += (line.empty() ? "" : ", ") + (value.is_object() ? key + " " : "") + line_of(part);
  return line;
}

/// Members that say in a sentence what a thing is.
constexpr std::string_view kProse[] = {"summary", "meaning", "holds", "claim", "what"};

Description described(const Json& thing) {
  return {thing_text(thing), thing};
}

/// The field at that path, of the first type that has it where types choose the fields; null when there is none.
const FieldGuide* find_field(const std::string& path) {
  const std::vector<PlacedField> all = placed_fields();
  const auto found = std::ranges::find(all, path, &PlacedField::path);
  return found == all.end() ? nullptr : found->field;
}

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

void add_models(Index& index) {
  const auto add = [&index](const char* kind, const ModelInfo& info, std::span<const OwnParameter> own = {},
                            const AlgorithmOrigin& origin = {}) {
    index.push_back({kind, info.name, info.summary,
                     [kind, &info, own, origin] { return described(model_json(kind, info, own, origin)); }});
  };
  for (const AlgorithmEntry& entry : algorithms()) add("algorithm", *entry.info, entry.own_parameters, entry.origin);
  for (const DepthModelEntry& entry : depth_models()) add("depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add("stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add("integrator", entry->info);
}

Description describe_preset(const DevicePreset& preset) {
  Description d;
  d.text = fmt::format("preset {}: {}\n{}", bold(stdout, preset.name), preset.device,
                       wrapped("of device.type \"impedance\": \"device\": {\"type\": \"impedance\", \"preset\": \"" +
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
    d.text += entry(fmt::format("{} {:g}", name, number.value), meaning + (std::string(number.source) + range), 2, 32);
    d.json["numbers"][name] = {
        {"value", number.value}, {"source", number.source}, {"low", number.low}, {"high", number.high}};
  }
  return d;
}

Description describe_stability() {
  Description d;
  d.json = {{"kind", "stability"}};
  for (const StiffnessLimit& limit : stiffness_limits())
    d.json["limits"].push_back(
        {{"name", limit.name}, {"formula", limit.formula}, {"applies", limit.applies}, {"source", limit.source}});
  d.text = "stability\n";
  d.text += wrapped(
      "A run is judged by its motion, quarter by quarter; the amplitude is the largest speed. One that is too short to "
      "tell is made up to 64 times as long.\n\n");
  for (std::size_t i = kMotionClasses; i-- > 0;)  // "all else" last
    d.text += entry(run_verdict_texts()[i].name, run_verdict_texts()[i].rule, 2, 13);
  d.text +=
      "\n" +
      wrapped(
          "Limits count stable and dying out as stable: the tool comes to rest if the run goes on. A run that goes through "
          "the surface, loses contact, is stuck or never touches (describe outcomes) has a class of its own and is not "
          "stable, however calm it is.\n\n"
          "The analytic limit, under leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M = 0 with lambda = lambda_max(S), is "
          "given where the tool is alone with springs that stay in contact and the force is -K S p. Under "
          "velocity_verlet and rk4 it is that of the eigenvalues of a step; the implicit integrators have none. With a "
          "device in the loop it is where the first eigenvalue of the loop of hand, handle and wall leaves the unit "
          "circle, as long as nothing saturates and the contact lasts. With --stable bounded the edge by bisection is that of "
          "\"diverged\".");
  d.text += "\nlimits of the stiffness K of a wall on an impedance device\n";
  d.text += wrapped(
      "b is the handle's damping, c its Coulomb friction, q the encoder's step, m the moving mass, T the period, t_d = d T "
      "the delay. Each is written beside the edge where it applies.");
  for (const Json& limit : d.json["limits"]) d.text += thing_text(limit, 2);
  return d;
}

Description describe_diagnosis() {
  Description d{"rules of the diagnosis, which run prints and writes to summary.json\n\n", Json::array()};
  for (const Diagnosed& rule : diagnosis_rules()) {
    const std::string unit = rule.unit == "1" ? "" : " " + rule.unit;
    d.text += entry(rule.rule, fmt::format("{} > {:g}{}", rule.number, rule.threshold, unit), 2, 14);
    d.json.push_back(
        {{"rule", rule.rule}, {"number", rule.number}, {"unit", rule.unit}, {"threshold", rule.threshold}});
  }
  return d;
}

// ---- The fields of scenario files

/// True for an object whose fields are told one by one: not the bounds on metrics, which are more than all others.
bool shows_fields(const ValueGuide& value) {
  constexpr std::size_t kMostShown = 50;
  return value.choices.empty() && !value.fields.empty() && value.fields.size() <= kMostShown;
}

bool is_object(const ValueGuide& value) {
  return value.choices.empty() && value.schema.is_object() && value.schema.contains("properties");
}

/// The default as JSON with blanks where a line may end; empty for none.
std::string default_of(const FieldGuide& field) {
  std::string text;
  if (field.presence == Presence::has_default)
    for (const char c : shown(field.initial)) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

/// The fields of an object and of those in it, each by its path from there, with what it may be and what it means.
std::string field_cards(const std::string& prefix, const ValueGuide& object, std::size_t indent) {
  std::string text;
  for (const FieldGuide& field : object.fields) {
    const bool nested = shows_fields(field.value);
    const std::string initial = nested ? "" : default_of(field);
    std::string facts = is_object(field.value) ? "" : field.value.allowed;
    if (!initial.empty()) facts += (facts.empty() ? "default " : "; default ") + initial;
    text += std::string(indent, ' ') + bold(stdout, prefix + field.name) + "\n";
    if (!facts.empty()) text += wrapped(facts, indent + 4);
    if (!field.meaning.empty()) text += wrapped(field.meaning, indent + 4);
    if (nested) text += field_cards(prefix + field.name + ".", field.value, indent);
  }
  return text;
}

/// The value behind its title: its fields as cards; of a choice among objects those of each; a few lines for a plain
/// value. `of` names the types or the field that have the value, where others have another of that title.
std::string value_text(const std::string& title, const std::string& of, const std::string& meaning,
                       const ValueGuide& value, const std::string& initial = "") {
  std::string text = bold(stdout, title) + "\n";
  if (!of.empty()) text += wrapped("of " + of);
  if (!meaning.empty()) text += wrapped(meaning);
  if (!is_object(value)) text += wrapped("allowed: " + value.allowed);
  if (shows_fields(value)) return text + "\n" + field_cards("", value, 2);
  if (is_object(value)) return value.fields.empty() ? text + "  no fields\n" : text;
  if (!initial.empty()) text += wrapped("default: " + initial);
  for (const ValueGuide& type : value.choices) {
    text += fmt::format("\n  type \"{}\"{}{}\n{}", bold(stdout, type.type), type.summary.empty() ? "" : ": ",
                        type.summary, field_cards("", type, 6));
  }
  return text;
}

/// The types among which the field at a path such as "hand.type" chooses; empty for a field that chooses none.
Description describe_types(const std::string& path) {
  const std::string end = std::string(".") + kTypeField;
  if (!path.ends_with(end)) return {};
  const std::string field = path.substr(0, path.size() - end.size());
  const FieldGuide* found = find_field(field);
  if (found == nullptr || found->value.choices.empty()) return {};
  std::string text = fmt::format("{}\n  chooses the fields of {}; \"hapbench describe {}\" shows those of each\n\n",
                                 bold(stdout, path), field, field);
  for (const ValueGuide& type : found->value.choices)
    text += entry(fmt::format("\"{}\"", type.type), type.summary, 4, 24);
  return {text, {{"field", path}, {"types", names_of(found->value.choices, &ValueGuide::type)}}};
}

/// The field at that path, once for each group of types that share it.
Description describe_field(const std::string& path) {
  if (Description types = describe_types(path); !types.text.empty()) return types;
  std::vector<PlacedField> found;
  for (const PlacedField& placed : placed_fields()) {
    if (placed.path != path) continue;
    const auto schema_of = [](const PlacedField& other) { return other.field->schema(); };
    const auto same = std::ranges::find(found, placed.field->schema(), schema_of);
    if (same == found.end())
      found.push_back(placed);
    else
      same->types += (placed.types.empty() ? "" : ", ") + placed.types;
  }
  std::vector<Description> meanings;
  for (const auto& [at, types, field] : found) {
    Json json = field->schema();
    if (!types.empty()) json["of"] = types;
    meanings.push_back({value_text(at, types, field->meaning, field->value, default_of(*field)), std::move(json)});
  }
  return joined(meanings);
}

Description describe_algorithms() {
  Description d = describe_field("rendering.algorithm");
  d.text += wrapped("\"hapbench describe algorithms\" shows them with what they do");
  return d;
}

Description describe_profile() {
  const FieldGuide& any = *find_field("motion.orientation.tilt_rad");  // whose value is a function of time
  Json schema = any.schema();
  schema["description"] = "a function of time: a number that does not change, or an object";
  schema.erase("default");
  return {value_text("profile", "", schema["description"].get<std::string>(), any.value), schema};
}

Description describe_scenario_fields() {
  const Json& schema = scenario_guide().schema;
  return {value_text("scenario", "", schema["description"].get<std::string>(), scenario_guide()), schema};
}

/// The types among which fields choose, those that are the same in several fields once.
void add_types(Index& index) {
  std::vector<std::pair<std::string, const ValueGuide*>> types;
  const auto schema_of = [](const auto& known) -> const Json& { return known.second->schema; };
  for (const PlacedField& placed : placed_fields())
    for (const ValueGuide& choice : placed.field->value.choices)
      if (std::ranges::find(types, choice.schema, schema_of) == types.end()) types.emplace_back(placed.path, &choice);
  for (const auto& [field, type] : types) {
    const auto has_the_name = [type = type](const auto& other) { return other.second->type == type->type; };
    const std::string of = std::ranges::count_if(types, has_the_name) > 1 ? field : "";
    index.push_back({field, type->type, type->summary, [type = type, of] {
                       return Description{value_text(type->type, of, type->summary, *type), type->schema};
                     }});
  }
}

// ---- Names that results and printed tables have: metrics, files, columns, words, headings

const std::vector<Column> kShellColumns = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

Description describe_metrics() {
  const Json json = {{"kind", "metrics"}, {"metrics", columns_json({}, all_metrics())["summary.json"]}};
  return {"metrics of summary.json, which expect.metrics may bound; f is f_render, the force on the tool\n" +
              thing_text(json),
          json};
}

Description describe_table(const DescribedTable& table) {
  Json columns = Json::array();
  for (const auto& [name, unit, meaning] : table.columns)
    columns.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  return described({{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", std::move(columns)}});
}

Description describe_tables() {
  std::vector<Description> all;
  for (const DescribedTable& table : result_tables())
    if (!table.file.empty()) all.push_back(describe_table(table));
  return joined(all);
}

struct Word {
  const char *name, *kind, *meaning;
};

constexpr const char* kTime = "number of timing.json";
constexpr const char* kResultFile = "file of the results";

/// Words that no enumeration has.
constexpr Word kWords[] = {
    {"step_p50_s", kTime, "what half of the steps take at most, each by itself, without observers and recorders [s]"},
    {"step_p99_s", kTime, "what 99 % of the steps take at most, each by itself, without observers and recorders [s]"},
    {"scenario.effective.json", kResultFile,
     "the scenario with every default filled in; run again it gives the same files"},
    {"timing.json", kResultFile,
     "of record.timing: wall times, percentiles, missed deadlines and histogram of single steps"},
    {"sweep.json", kResultFile,
     "what a sweep's table is a function of: scenario, overrides, points, named files, program"},
    {"sweep.csv.part", kResultFile,
     "rows of a sweep that is under way or was interrupted, from which --resume goes on"},
    {"sweep.I_of_N.csv", kResultFile,
     "rows of a shard of a sweep, which \"hapbench sweep FOLDER\" joins; columns as in sweep.csv"},
    {"report.html", kResultFile, "a page to read and replay, of report or scripts/reproduce"},
    {"plot.svg", kResultFile, "the picture of plot"},
    {"figures.json", kResultFile,
     "figures that scripts/figures drew, with their captions and the files they were drawn of"},
    {"claims.json", kResultFile, "the ledger of reproduce: claims, what was measured, verdicts, robustness"},
    {"claims.md", kResultFile, "the ledger of reproduce, for people"},
    {"choices.json", kResultFile, "what the thesis leaves open and what was chosen; \"describe choices_schema\""},
    {"robustness.csv", kResultFile, "of reproduce --choices: the choices and verdicts of each reading"},
    {"robustness.json", kResultFile,
     "how many samples have the verdict on record, and which choices decide it, for each claim"},
    {"quantum", "number of import",
     "the step in which the recorded places come along an axis, seen in their differences (its row resolution, quantum_m of "
     "--json); K times it is the step of force that the recording alone makes"}};

Json all_words() {
  Json all = Json::array();
  const auto add = [&all](std::string_view name, const char* kind, const char* meaning) {
    all.push_back({{"kind", kind}, {"name", name}, {"meaning", meaning}});
  };
  for (const auto& [name, kind, meaning] : kWords) add(name, kind, meaning);
  for (const OutcomeInfo& outcome : outcome_infos()) add(outcome.name, "outcome of a run", outcome.meaning);
  for (const RunVerdictText& verdict : run_verdict_texts())
    add(verdict.name, "class of motion, of limit and stability", verdict.meaning);
  for (const auto& [name, meaning, mark] : kVerdicts) add(name, "verdict on a claim", meaning);
  return all;
}

Description describe_words() {
  const Json json = {{"kind", "words"}, {"words", all_words()}};
  return {"words that the program prints\n" + thing_text(json), json};
}

void add_term(Index& index, const Json& json) {
  const auto text = [&](const char* key) { return json.at(key).get<std::string>(); };
  index.push_back({text("kind"), text("name"), text("meaning"), [json] { return described(json); }});
}

/// The columns of all files, those of one name and meaning once.
void add_columns(Index& index, const std::vector<DescribedTable>& tables) {
  std::vector<Json> all;
  for (const DescribedTable& table : tables) {
    if (table.file.empty()) continue;
    for (const auto& [name, unit, meaning] : table.columns) {
      Json column = {{"kind", "column"}, {"name", name}, {"unit", unit}, {"meaning", meaning}};
      const auto same = std::ranges::find_if(all, [&column](const Json& known) {
        return known["name"] == column["name"] && known["meaning"] == column["meaning"];
      });
      (same != all.end() ? *same : all.emplace_back(std::move(column)))["files"].push_back(table.file);
    }
  }
  for (const Json& column : all) add_term(index, column);
}

/// Names that stand for no single thing of a list.
constexpr std::pair<const char*, Description (*)()> kSections[] = {
    {"metrics", describe_metrics},          {"summary.json", describe_metrics},
    {"columns", describe_tables},           {"columns.json", describe_tables},
    {"algorithm", describe_algorithms},     {"profile", describe_profile},
    {"scenario", describe_scenario_fields}, {"choices_schema", [] { return Description{"", choices_schema()}; }},
    {"diagnosis", describe_diagnosis},      {"schema", [] { return Description{"", scenario_schema()}; }},
    {"stability", describe_stability},      {"words", describe_words}};

}  // namespace

std::string thing_text(const Json& thing, std::size_t indent) {
  std::string name = thing.value("name", "");
  std::replace(name.begin(), name.end(), '\n', ' ');
  const std::string kind = thing.value("kind", ""), unit = thing.value("unit", "");
  std::string prose, facts, lists;
  for (const auto& [key, value] : thing.items()) {
    if (key == "kind" || key == "name" || key == "unit") continue;
    std::string title = key;
    std::replace(title.begin(), title.end(), '_', ' ');
    if (value.is_array() && !value.empty() && value.front().is_object()) {
      lists += fmt::format("\n{:{}}{}\n", "", indent + 2, title);
      for (const Json& item : value) lists += thing_text(item, indent + 4);
    } else if (const std::string line = line_of(value); !line.empty()) {
      if (std::ranges::find(kProse, key) != std::end(kProse))
        prose += wrapped(line, indent + 2);
      else
        facts += entry(title, line, indent + 2, indent + 17);
    }
  }
  std::string text;
  if (!name.empty()) {
    if (!unit.empty()) name += fmt::format(" [{}]", unit);
    text = fmt::format("{:{}}{}{}{}\n", "", indent, bold(stdout, name), kind.empty() ? "" : ": ", kind);
  }
  return text + prose + (facts.empty() || indent > 0 ? "" : "\n") + facts + lists;
}

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const ResultTable& table) {
    DescribedTable& added = tables.emplace_back(DescribedTable{table.file, table.holds});
    for (const auto& [name, unit, meaning] : table.columns) added.columns.push_back({name, unit, meaning});
  };
  for (const ResultTable& table : record_tables()) add(table);
  add(kTargetTable);
  for (auto* tables_of : {run_tables, single_run_tables, league_tables, limit_tables, converge_tables, tune_tables,
                          claim_tables, sweep_tables, stress_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  add({"shell.csv", "of validate --points: one line per point of the environment", kShellColumns});
  return tables;
}

Index program_index() {
  const std::vector<DescribedTable> tables = result_tables();
  Index index;
  add_models(index);
  for (const DevicePreset& preset : device_presets())
    index.push_back({"preset", preset.name, preset.device, [&preset] { return describe_preset(preset); }});
  for (const auto& [name, describe] : kSections) index.push_back({"section", name, "", describe});
  for (const Metric& metric : all_metrics())
    add_term(index, {{"kind", "metric"}, {"name", metric.name}, {"unit", metric.unit}, {"meaning", metric.meaning}});
  for (const DescribedTable& table : tables)
    if (!table.file.empty()) index.push_back({"file", table.file, "", [table] { return describe_table(table); }});
  add_columns(index, tables);
  for (const std::string& path : scenario_field_paths())
    index.push_back({"field", path, "", [path] { return describe_field(path); }});
  add_types(index);
  for (const Json& word : all_words()) add_term(index, word);
  for (const DescribedTable& table : tables)
    for (const Table::Column& heading : table.headings)
      if (!heading.meaning.empty())
        add_term(index, {{"kind", "heading"}, {"name", heading.title}, {"meaning", heading.meaning}});
  return index;
}

}  // namespace hapbench
