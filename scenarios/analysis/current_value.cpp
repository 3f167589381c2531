#include "scenarios/analysis/current_value.hpp"

#include <nlohmann/json.hpp>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

Json current_value(const Scenario& scenario, const std::string& path) {
  const Json effective = effective_scenario(scenario, scenario.directory);
  Json::json_pointer at;
  for (const std::string_view key : parts_of(path, '.')) at /= std::string(key);
  return effective.contains(at) ? effective.at(at) : Json();
}

}  // namespace hapbench
