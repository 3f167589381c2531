#include "scenarios/program/index.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <tuple>

#include "algorithms/registry.hpp"
#include "device_model/device_presets.hpp"
#include "device_model/theory/stiffness_limits.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/scenario.hpp"
#include "scenarios/limits/stability/run_stability.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/claims.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {

std::string facts_text(std::initializer_list<std::pair<const char*, std::string>> facts, std::size_t column) {
  std::string text;
  for (const auto& [title, fact] : facts)
    if (!fact.empty()) text += entry(title, fact, 2, column);
  return text;
}

Description joined(const std::vector<Description>& meanings) {
  if (meanings.size() == 1) return meanings.front();
  Description all{"", Json::array()};
  for (const Description& meaning : meanings) {
    all.text += (all.text.empty() ? "" : "\n") + meaning.text;
    // A meaning that has several itself adds each.
    const Json list = meaning.json.is_array() ? meaning.json : Json::array({meaning.json});
    all.json.insert(all.json.end(), list.begin(), list.end());
  }
  return all;
}

namespace {

/// Appends the card of a parameter to the model's.
void add_parameter(Description& d, const std::string& path, const char* unit, const char* meaning) {
  const FieldGuide& field = *find_field(path);
  const std::string initial = default_text(field), range = field.value.allowed;
  d.text += card({.name = path, .initial = initial, .allowed = range, .meaning = meaning}, 4);
  d.json["parameters"].push_back(
      {{"name", path}, {"unit", unit}, {"default", initial}, {"range", range}, {"meaning", meaning}});
}

Description describe_model(const char* kind, const ModelInfo& info, std::span<const OwnParameter> own,
                           const AlgorithmOrigin& origin) {
  Description d;
  d.text = fmt::format("{} {}\n{}\n", kind, bold(stdout, info.name), wrapped(info.summary)) +
           facts_text({{"formula", info.formula}, {"source", info.source}, {"known failure", info.known_failure}}, 17);
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

void add_models(Index& index) {
  const auto add = [&index](const char* kind, const ModelInfo& info, std::span<const OwnParameter> own = {},
                            const AlgorithmOrigin& origin = {}) {
    index.push_back({kind, info.name, info.summary,
                     [kind, &info, own, origin] { return describe_model(kind, info, own, origin); }});
  };
  for (const AlgorithmEntry& entry : algorithms()) add("algorithm", *entry.info, entry.own_parameters, entry.origin);
  for (const DepthModelEntry& entry : depth_models()) add("depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add("stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add("integrator", entry->info);
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

/// The field at that path, once for each group of types that share it.
Description describe_field(const std::string& path) {
  if (const std::string values = types_text(path); !values.empty())
    return {values, {{"field", path}, {"types", type_names(path.substr(0, path.rfind('.')))}}};
  std::vector<Description> meanings;
  for (const auto& [types, field] : typed_fields(path)) {
    Json json = field->schema();
    if (!types.empty()) json["of"] = types;
    meanings.push_back({fields_text(path, *field, types), std::move(json)});
  }
  return joined(meanings);
}

Description describe_algorithms() {
  Description d = describe_field("rendering.algorithm");
  d.text += wrapped("\"hapbench describe algorithms\" shows them with what they do");
  return d;
}

Description describe_profile() {
  // Any field whose value is a function of time.
  FieldGuide profile = *find_field("motion.orientation.tilt_rad");
  profile.meaning = "a function of time: a number that does not change, or an object";
  profile.presence = Presence::no_default;
  return {fields_text("profile", profile), profile.schema()};
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
  for (std::size_t i = kMotionClasses; i-- > 0;)  // "all else" last
    d.text += entry(run_verdict_texts()[i].name, run_verdict_texts()[i].rule, 2, 13);
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
void add_sections(Index& index) {
  const auto add = [&index](const char* name, Description (*describe)()) {
    index.push_back({"section", name, "", describe});
  };
  add("choices_schema", [] { return Description{"", choices_schema()}; });
  add("diagnosis", describe_diagnosis);
  add("profile", describe_profile);
  add("scenario", [] { return Description{fields_text("scenario", scenario_guide()), scenario_guide().schema}; });
  add("schema", [] { return Description{"", scenario_schema()}; });
  add("stability", describe_stability);
}

void add_types(Index& index) {
  const std::vector<FieldType> types = all_types();
  for (const FieldType& found : types) {
    const ValueGuide* type = found.type;
    const auto has_the_name = [type](const FieldType& other) { return other.type->type == type->type; };
    const std::string of = std::ranges::count_if(types, has_the_name) > 1 ? found.field : "";
    index.push_back({found.field, type->type, type->summary, [type, of] {
                       return Description{fields_text(type->type, *type, of), type->schema};
                     }});
  }
}

// ---- Names that results and printed tables have: metrics, files, columns, words, headings

constexpr Column kShellColumns[] = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

std::string titled(std::string_view name, std::string_view unit) {
  return unit.empty() ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

/// Explains columns or metrics.
template <class Entries>
std::string entries_text(const Entries& entries) {
  std::string text;
  for (const auto& entry : entries) text += "  " + titled(entry.name, entry.unit) + "\n" + wrapped(entry.meaning, 6);
  return text;
}

Description describe_metrics() {
  const MetricList metrics = metrics_without_values();
  return {"metrics of summary.json, which expect.metrics may bound; f is f_render, the force on the tool\n\n" +
              entries_text(metrics),
          {{"kind", "metrics"}, {"metrics", columns_json(metrics)}}};
}

Description describe_table(const DescribedTable& table) {
  Json columns = Json::array();
  for (const auto& [name, unit, meaning] : table.columns)
    columns.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  return {fmt::format("{}: file\n{}\n{}", bold(stdout, table.file), wrapped(table.holds), entries_text(table.columns)),
          {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", std::move(columns)}}};
}

Description describe_tables() {
  std::vector<Description> all;
  for (const DescribedTable& table : result_tables())
    if (!table.file.empty()) all.push_back(describe_table(table));
  return joined(all);
}

struct Word {
  std::string_view name;
  const char* kind;
  const char* meaning;
};

constexpr const char* kOutcome = "outcome of a run";
constexpr const char* kMotion = "class of motion, of limit and stability";
constexpr const char* kTime = "number of timing.json";
constexpr const char* kVerdict = "verdict on a claim";
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

std::vector<Word> all_words() {
  std::vector<Word> all(std::begin(kWords), std::end(kWords));
  for (const OutcomeInfo& outcome : outcome_infos()) all.push_back({outcome.name, kOutcome, outcome.meaning});
  for (const RunVerdictText& verdict : run_verdict_texts()) all.push_back({verdict.name, kMotion, verdict.meaning});
  for (const auto& [name, meaning, mark] : kVerdicts) all.push_back({name, kVerdict, meaning});
  return all;
}

Json word_json(const Word& word) {
  return {{"kind", word.kind}, {"name", word.name}, {"meaning", word.meaning}};
}

Description describe_words() {
  Description d{"words that the program prints\n\n", {{"kind", "words"}, {"words", Json::array()}}};
  for (const Word& word : all_words()) {
    d.text += fmt::format("  {} ({})\n{}", word.name, word.kind, wrapped(word.meaning, 6));
    d.json["words"].push_back(word_json(word));
  }
  return d;
}

/// Adds a name with one meaning; `title` has its unit, `kind_text` also where it is.
void add_term(Index& index, Json json, const std::string& title, const std::string& kind_text,
              const std::string& summary) {
  const std::string kind = json["kind"], name = json["name"], meaning = json["meaning"];
  const auto describe = [=] {
    return Description{fmt::format("{}: {}\n{}", bold(stdout, title), kind_text, wrapped(meaning)), json};
  };
  index.push_back({kind, name, summary, describe});
}

/// The columns of all files, those of one name and meaning once.
void add_columns(Index& index, const std::vector<DescribedTable>& tables) {
  std::vector<std::pair<DescribedTable::Entry, std::vector<std::string>>> all;
  for (const DescribedTable& table : tables) {
    for (const DescribedTable::Entry& column :
         table.file.empty() ? std::vector<DescribedTable::Entry>() : table.columns) {
      const auto same = std::ranges::find_if(all, [&column](const auto& known) {
        return known.first.name == column.name && known.first.meaning == column.meaning;
      });
      (same != all.end() ? *same : all.emplace_back(column, std::vector<std::string>())).second.push_back(table.file);
    }
  }
  for (const auto& [column, files] : all) {
    const auto& [name, unit, meaning] = column;
    add_term(index, {{"kind", "column"}, {"name", name}, {"unit", unit}, {"meaning", meaning}, {"files", files}},
             titled(name, unit), fmt::format("column of {}", fmt::join(files, ", ")), "");
  }
}

/// Metrics, files, columns.
void add_results(Index& index, const std::vector<DescribedTable>& tables) {
  for (const char* name : {"metrics", "summary.json"}) index.push_back({"section", name, "", describe_metrics});
  for (const Metric& metric : metrics_without_values()) {
    add_term(index, {{"kind", "metric"}, {"name", metric.name}, {"unit", metric.unit}, {"meaning", metric.meaning}},
             titled(metric.name, metric.unit), "metric", metric.meaning);
  }
  for (const char* name : {"columns", "columns.json"}) index.push_back({"section", name, "", describe_tables});
  for (const DescribedTable& table : tables)
    if (!table.file.empty()) index.push_back({"file", table.file, "", [table] { return describe_table(table); }});
  add_columns(index, tables);
}

/// Outcomes, classes of motion, verdicts and others that the program prints.
void add_words(Index& index) {
  index.push_back({"section", "words", "", describe_words});
  for (const Word& word : all_words()) {
    const char* more = word.kind == kMotion ? "; in numbers: hapbench describe stability" : "";
    add_term(index, word_json(word), std::string(word.name), std::string(word.kind) + more, "");
  }
}

/// Headings of printed tables, whose `summary`, a name or a sentence, says what they mean.
void add_headings(Index& index, const std::vector<DescribedTable>& tables) {
  for (const DescribedTable& table : tables) {
    for (const Table::Column& heading : table.headings) {
      if (heading.meaning.empty()) continue;
      const std::string title = heading.title.substr(0, heading.title.find_last_not_of(' ') + 1);
      add_term(index, {{"kind", "heading"}, {"name", heading.title}, {"meaning", heading.meaning}},
               fmt::format("\"{}\"", title), "heading", heading.meaning);
    }
  }
}

}  // namespace

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    DescribedTable& table = tables.emplace_back(DescribedTable{file, holds});
    for (const auto& [name, unit, meaning] : columns) table.columns.push_back({name, unit, meaning});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, table.columns);
  add(kTargetTable.file, kTargetTable.holds, kTargetTable.columns);
  for (auto* tables_of : {run_tables, league_tables, limit_tables, converge_tables, tune_tables, claim_tables,
                          sweep_tables, stress_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  add("shell.csv", "of validate --points: one line per point of the environment", kShellColumns);
  return tables;
}

Index program_index() {
  const std::vector<DescribedTable> tables = result_tables();
  Index index;
  add_models(index);
  for (const DevicePreset& preset : device_presets())
    index.push_back({"preset", preset.name, preset.device, [&preset] { return describe_preset(preset); }});
  index.push_back({"section", "algorithm", "", describe_algorithms});
  add_results(index, tables);
  for (const std::string& path : scenario_field_paths())
    index.push_back({"field", path, "", [path] { return describe_field(path); }});
  add_sections(index);
  add_types(index);
  add_words(index);
  add_headings(index, tables);
  return index;
}

}  // namespace hapbench
