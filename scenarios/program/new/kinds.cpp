#include "scenarios/program/new/kinds.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

const std::vector<StartKind>& start_kinds() {
  static const std::vector<StartKind> kinds = [] {
    const Json json = parse_json(read_named_file(installed_folder("scenarios/library") / "starts.json"));
    std::vector<StartKind> all;
    for (const Json& kind : json.at("kinds")) {
      Json scene = {{"description", kind.at("summary")},
                    {"time", {{"step_s", kStartStep}, {"steps", kind.value("steps", 2000)}}}};
      for (const Json& part : kind.at("parts")) scene.update(json.at("parts").at(part.get<std::string>()));
      const auto text = [&](const char* key) { return kind.at(key).get<std::string>(); };
      all.push_back({text("kind"), text("summary"), kind.value("from", ""), kind.value("optional", false), scene});
    }
    return all;
  }();
  return kinds;
}

const StartKind& kind_named(const std::string& name) {
  require_valid_name("KIND: got", name, names_of(start_kinds(), &StartKind::name), "hapbench new");
  return *std::ranges::find(start_kinds(), name, &StartKind::name);
}

}  // namespace hapbench
