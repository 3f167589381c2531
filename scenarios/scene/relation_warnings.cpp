#include "scenarios/scene/relation_warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/describe_rendering.hpp"

namespace hapbench {
namespace {

constexpr const char* kNoEffect = "no_effect";  ///< of warnings: a given value that nothing reads

/// Warnings about values in `json` that the scenario does not have, because the algorithm's definition fixes others,
/// and about contacts that the algorithm does not have by its definition.
void warn_of_fixed_stages(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  const RenderingConfig& fixed = scenario.rendering;
  const AlgorithmEntry& entry = *find_algorithm(fixed.algorithm);
  const std::string depth_model = json.value("rendering", Json::object()).value("depth_model", fixed.depth_model);
  if (!std::holds_alternative<SpringsEnvironment>(scenario.environment) && depth_model != fixed.depth_model) {
    warnings.push_back({kNoEffect, "/rendering/depth_model",
                        fmt::format("\"{}\" is not used: algorithm \"{}\" requires \"{}\"", depth_model,
                                    fixed.algorithm, fixed.depth_model)});
  }
  if (has_other_contacts(scenario) && !entry.reported_depth_model.empty()) {
    warnings.push_back({kNoEffect, "/rendering/contact_source",
                        fmt::format("not used: algorithm \"{}\" finds its contacts itself", fixed.algorithm)});
  } else if (has_other_contacts(scenario) && !entry.fixed_depth_model.empty()) {
    warnings.push_back(
        {"other_depths", "/rendering/contact_source",
         fmt::format("algorithm \"{}\" is defined with depth model \"{}\", but here it receives the depths of \"{}\"",
                     fixed.algorithm, entry.fixed_depth_model, fixed.contact_source)});
  }
  const Json::json_pointer reduction("/rendering/reduction");
  if (!fixed.reduction && json.contains(reduction) && !json.at(reduction).is_null()) {
    warnings.push_back({kNoEffect, reduction.to_string(),
                        fmt::format("not used: algorithm \"{}\" is defined without a reduction", fixed.algorithm)});
  }
}

void warn_of_idle_integrator(const Scenario& scenario, std::vector<Warning>& warnings) {
  if (!handle_moves_tool(scenario.device) || scenario.integrator.type == IntegratorFields{}.type) return;
  warnings.push_back(
      {kNoEffect, "/integrator/type",
       fmt::format(
           "\"{}\" is not used: with device \"impedance\" the handle moves the tool, and no virtual mass is integrated",
           scenario.integrator.type->info.name)});
}

/// A warning about an admittance device whose servo or mechanics differ from the usual ones under a hand that does not
/// feel the handle. Sensor and limiter have an effect under any hand, so a device that changes only these is fine.
void warn_of_idle_device(const Scenario& scenario, std::vector<Warning>& warnings) {
  const char* hand = std::holds_alternative<NoHandFields>(scenario.hand)      ? "none"
                     : std::holds_alternative<ForceHandFields>(scenario.hand) ? "force"
                     : std::holds_alternative<PushHandFields>(scenario.hand)  ? "push"
                                                                              : nullptr;
  const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  if (hand == nullptr || device == nullptr) return;
  const AdmittanceDeviceConfig usual;
  const bool changes_loop = device->servo != usual.servo || device->mechanics != usual.mechanics;
  if (!changes_loop && (device->sensor != usual.sensor || device->force_limit != usual.force_limit)) return;
  warnings.push_back(
      {kNoEffect, "/device",
       fmt::format(
           "servo and mechanics (lag, delay, structure) move only the handle; with hand.type \"{}\" they have no "
           "effect on the tool and its force, because this hand does not react to the handle (\"impedance\", \"drag\" "
           "and \"tracking\" do)",
           hand)});
}

/// True when the algorithm documents the field as one of its parameters.
bool reads(const AlgorithmEntry& algorithm, std::string_view field) {
  const auto is_field = [field](const ParameterInfo& info) { return info.parameter.field == field; };
  return std::ranges::any_of(algorithm.info->parameters, is_field);
}

/// Warnings about values in `json`, other than the defaults, that the rendering does not read: parameters of other
/// algorithms, and the filter of a velocity that nothing sees.
void warn_of_unread_rendering(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  const AlgorithmEntry& own = *find_algorithm(scenario.rendering.algorithm);
  const Json initial = {{"rendering", written_object(RenderingConfig{})}};
  std::map<std::string, std::vector<std::string>> readers;  // pointer of a field -> algorithms
  for (const AlgorithmEntry& other : algorithms()) {
    for (const ParameterInfo& info : other.info->parameters) {
      if (reads(own, info.parameter.field)) continue;
      std::string pointer = "/" + std::string(info.parameter.field);
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      readers[pointer].emplace_back(other.info->name);
    }
    if (&other == &own) continue;
    for (const OwnParameter& parameter : other.own_parameters)
      readers[fmt::format("/rendering/parameters/{}/{}", other.info->name, parameter.name)] = {other.info->name};
  }
  const auto is_given = [&](const std::string& pointer) {
    const Json::json_pointer at(pointer);
    return json.contains(at) && !(initial.contains(at) && initial.at(at) == json.at(at));
  };
  for (const auto& [pointer, names] : readers) {
    if (!is_given(pointer)) continue;
    warnings.push_back(
        {kNoEffect, pointer,
         fmt::format("has no effect on this algorithm; it is a parameter of {}", fmt::join(names, ", "))});
  }
  for (const char* pointer : {"/rendering/damping_ratio", "/rendering/damping_N_s_per_m"}) {
    if (scenario.rendering.hunt_crossley && is_given(pointer))
      warnings.push_back({kNoEffect, pointer, "has no effect together with rendering.damping"});
  }
  constexpr const char* kCutoff = "/rendering/angular_velocity_cutoff_Hz";
  if (is_given(kCutoff) && !scenario.rendering.angular_damping)
    warnings.push_back({kNoEffect, kCutoff, "has no effect without rendering.angular_damping"});
}

/// A warning where the integrator does not step the bristle of dry friction stably: the tool never comes to rest.
void warn_of_stiff_bristle(const Scenario& scenario, std::vector<Warning>& warnings) {
  const RenderingConfig& r = scenario.rendering;
  if (!r.dry_friction || handle_moves_tool(scenario.device)) return;
  const SpringDamper bristle = bristle_of(*r.dry_friction, r, scenario.time.step);
  if (bristle.is_stable()) return;
  warnings.push_back(
      {"stiff_bristle", "/rendering/friction",
       fmt::format(
           "a sticking tool will chatter: a bristle of {:.4g} N/m is too stiff for a time step of {:.4g} s and a mass "
           "of {:.4g} kg",
           bristle.K, bristle.dt, r.mass)});
}

/// The first script within `json`, found at `at`, that a run of so long [s] does not play. The reader has checked it.
std::optional<Warning> first_unplayed(const Json& json, const std::string& at, double duration) {
  if (!json.is_object()) return std::nullopt;
  if (json.value("type", Json()) == "waypoints") {
    const Json& points = json.at("points");
    if (points.size() < 2 || points[points.size() - 2][0].get<double>() < duration) return std::nullopt;
    return Warning{"unplayed_script", at,
                   fmt::format("the script's last waypoint is at {:.6g} s, but the run ends at {:.6g} s; is "
                               "time.duration_s (or steps) right?",
                               points.back()[0].get<double>(), duration)};
  }
  for (const auto& field : json.items()) {
    if (auto found = first_unplayed(field.value(), at + "/" + field.key(), duration)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json) {
  std::vector<Warning> warnings;
  warn_of_fixed_stages(scenario, json, warnings);
  warn_of_idle_integrator(scenario, warnings);
  warn_of_idle_device(scenario, warnings);
  warn_of_unread_rendering(scenario, json, warnings);
  warn_of_stiff_bristle(scenario, warnings);
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  for (const char* part : {"hand", "motion"}) {
    if (!json.contains(part)) continue;
    if (auto found = first_unplayed(json.at(part), fmt::format("/{}", part), duration)) warnings.push_back(*found);
  }
  return warnings;
}

}  // namespace hapbench
