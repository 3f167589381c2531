#include "scenarios/program/tune/loop_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

namespace hapbench {
namespace {

/// Endings of the names of scaled fields. The hand feels the value of a scaled field multiplied by the scale of the
/// mount.
constexpr std::array<std::string_view, 4> kScaledUnits = {"_N_per_m", "_N_s_per_m", "_s_per_m", "_kg"};

/// Adds an override for each scaled field within `value`, which divides the field by the scale. `path`: dotted path of
/// `value` in the scenario.
void add_overrides(const Json& value, const std::string& path, double scale, std::vector<std::string>& overrides) {
  if (value.is_object()) {
    for (const auto& [name, member] : value.items()) {
      std::string member_path = path;
      member_path += "." + name;
      add_overrides(member, member_path, scale, overrides);
    }
    return;
  }
  const bool is_scaled = std::any_of(kScaledUnits.begin(), kScaledUnits.end(),
                                     [&](std::string_view unit) { return std::string_view(path).ends_with(unit); });
  if (is_scaled && value.is_number() && value.get<double>() != 0.0)
    overrides.push_back(fmt::format("{}={}", path, value.get<double>() / scale));
}

}  // namespace

std::vector<std::string> overrides_for_scale(const Json& scenario, double scale) {
  std::vector<std::string> overrides;
  if (scale != 1.0) add_overrides(scenario.at("rendering"), "rendering", scale, overrides);
  return overrides;
}

std::string loop_lines(const Json& scenario, const std::filesystem::path& file, double scale) {
  const std::string opened = fmt::format("setup.scenario = {};\n", Json(file.string()).dump());
  const std::vector<std::string> overrides = overrides_for_scale(scenario, scale);
  if (overrides.empty()) return "for your own loop (scenarios/LOOP.md): " + opened;
  std::string text = fmt::format(
      "for your own loop (scenarios/LOOP.md). With this scale the hand feels {0:g} times the coefficients of the "
      "scenario, so these lines divide the coefficients by {0:g}; a force then "
      "presses the tool {0:g} times as deep:\n  setup.mount.scale = {0};\n  {1}"
      "  static const char* const overrides[] = {{\n",
      scale, opened);
  for (const std::string& override : overrides) text += fmt::format("      {},\n", Json(override).dump());
  return text + "      NULL};\n  setup.overrides = overrides;\n";
}

}  // namespace hapbench
