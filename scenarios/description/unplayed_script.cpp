#include "scenarios/description/unplayed_script.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

namespace hapbench {
namespace {

/// The first script within `json`, found at `at`, that a run of so long [s] does not play. The reader has checked it.
std::optional<std::string> first_unplayed(const Json& json, const std::string& at, double duration) {
  if (!json.is_object()) return std::nullopt;
  if (json.value("type", Json()) == "waypoints") {
    const Json& points = json.at("points");
    if (points.size() < 2 || points[points.size() - 2][0].get<double>() < duration) return std::nullopt;
    return fmt::format(
        "{}: the script's last waypoint is at {:.6g} s, but the run ends at {:.6g} s; is time.duration_s (or steps) "
        "right?",
        at, points.back()[0].get<double>(), duration);
  }
  for (const auto& field : json.items()) {
    if (auto found = first_unplayed(field.value(), at + "/" + field.key(), duration)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> unplayed_script_warnings(const Json& json, const Scenario& scenario) {
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  std::vector<std::string> warnings;
  for (const char* part : {"hand", "motion"}) {
    if (!json.contains(part)) continue;
    if (auto found = first_unplayed(json.at(part), fmt::format("/{}", part), duration)) warnings.push_back(*found);
  }
  return warnings;
}

}  // namespace hapbench
