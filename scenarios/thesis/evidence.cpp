#include "scenarios/thesis/evidence.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"

namespace hapbench {

double Evidence::number(const std::string& scenario, const std::string& path) const {
  provide(scenario);
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const Json summary = read_json(directory / scenario / "summary.json");
  const Json value = summary.value(Json::json_pointer(pointer), Json());
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::map<std::string, std::vector<double>> Evidence::table(const std::string& scenario, const std::string& file) const {
  provide(scenario);
  const std::filesystem::path path = directory / scenario / file;
  const std::string text = read_named_file(path);
  if (text.empty()) fail_in_file(path, "is empty; allowed: a header and rows");
  CsvReader csv{LineReader(text), path};
  std::vector<std::vector<double>*> columns;
  std::map<std::string, std::vector<double>> table;
  for (const std::string_view name : csv.columns()) columns.push_back(&table[std::string(name)]);
  while (csv.next())
    for (std::size_t i = 0; i < columns.size(); ++i)
      columns[i]->push_back(finite_number(csv.cells()[i]).value_or(std::numeric_limits<double>::quiet_NaN()));
  return table;
}

Cases Evidence::scene(const std::string& name, const std::vector<std::string>& more) const {
  if (used) used(name);
  const ScenarioText text = read_scenario_text(find_scenario(name));
  std::vector<std::string> all;
  if (overrides) all = overrides(load_scenario(text, {}).scenario);
  all.insert(all.end(), more.begin(), more.end());
  return {{text}, std::move(all), {}};
}

LoadedScenario Evidence::load(const std::string& name, const std::vector<std::string>& more) const {
  return scene(name, more).load(0);
}

Result Evidence::run(const std::string& name, const std::vector<std::string>& more) const {
  return run_scenario(checked(load(name, more)), std::nullopt, false);
}

}  // namespace hapbench
