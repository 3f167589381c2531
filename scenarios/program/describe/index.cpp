#include "scenarios/program/describe/index.hpp"

#include <utility>

#include "scenarios/program/describe/fields.hpp"
#include "scenarios/program/describe/models.hpp"
#include "scenarios/program/describe/result_names.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "scenarios/thesis/choices.hpp"

namespace hapbench {
namespace {

/// Names that stand for no single thing of a list.
constexpr std::pair<const char*, Description (*)()> kSections[] = {
    {"metrics", describe_metrics},          {"summary.json", describe_metrics},
    {"columns", describe_tables},           {"columns.json", describe_tables},
    {"algorithm", describe_algorithms},     {"profile", describe_profile},
    {"scenario", describe_scenario_fields}, {"choices_schema", [] { return Description{"", choices_schema()}; }},
    {"diagnosis", describe_diagnosis},      {"schema", [] { return Description{"", scenario_schema()}; }},
    {"stability", describe_stability},      {"words", describe_words}};

}  // namespace

Index program_index() {
  const std::vector<DescribedTable> tables = result_tables();
  Index index;
  add_models(index);
  add_presets(index);
  for (const auto& [name, describe] : kSections) index.push_back({"section", name, "", describe});
  add_metric_terms(index);
  for (const DescribedTable& table : tables)
    if (!table.file.empty()) index.push_back({"file", table.file, "", [table] { return describe_table(table); }});
  add_columns(index, tables);
  for (const std::string& path : scenario_field_paths())
    index.push_back({"field", path, "", [path] { return describe_field(path); }});
  add_types(index);
  add_words(index);
  add_headings(index, tables);
  return index;
}

}  // namespace hapbench
