#include "scenarios/program/describe/index.hpp"

#include <utility>

#include "scenarios/program/describe/command_names.hpp"
#include "scenarios/program/describe/fields.hpp"
#include "scenarios/program/describe/json_keys.hpp"
#include "scenarios/program/describe/models.hpp"
#include "scenarios/program/describe/result_names.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "scenarios/thesis/assumptions.hpp"

namespace hapbench {
namespace {

/// Names whose descriptions cover several entries.
constexpr std::pair<const char*, Description (*)(const Layout&)> kSections[] = {
    {"metrics", describe_metrics},
    {"summary.json", describe_metrics},
    {"columns", describe_tables},
    {"columns.json", describe_tables},
    {"algorithm", describe_algorithms},
    {"profile", describe_profile},
    {"scenario", describe_scenario_fields},
    {"assumptions_schema",
     [](const Layout&) {
       return Description{"", assumptions_schema()};
     }},
    {"diagnosis", describe_diagnosis},
    {"schema",
     [](const Layout&) {
       return Description{"", scenario_schema()};
     }},
    {"stability", describe_stability},
    {"words", describe_printed_names}};

}  // namespace

Index program_index(const Layout& layout) {
  // Entries are in the order of the lists of `describe`. Headings come last because they refer to other entries.
  const std::vector<DescribedTable> tables = result_tables();
  Index index;
  add_models(index, layout);
  add_presets(index, layout);
  for (const auto& [name, describe] : kSections)
    index.push_back({"section", name, "", [describe = describe, layout] { return describe(layout); }});
  add_metric_terms(index, tables, layout);
  for (const DescribedTable& table : tables)
    if (!table.file.empty())
      index.push_back({"file", table.file, "", [table, layout] { return describe_table(table, layout); }});
  add_columns(index, tables, layout);
  for (const std::string& path : scenario_field_paths())
    index.push_back({"field", path, "", [path, layout] { return describe_field(path, layout); }});
  add_types(index, layout);
  add_printed_names(index, layout);
  add_json_keys(index, layout);
  add_commands(index, layout);
  add_headings(index, tables, layout);
  return index;
}

}  // namespace hapbench
