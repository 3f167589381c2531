#include "scenarios/scene/relation_warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/describe_rendering.hpp"

namespace hapbench {
namespace {

/// Warns about a depth model or reduction in `json` that differs from the depth model or reduction that the
/// algorithm fixes. Also warns about contacts from a recording or a shared library in two cases: the algorithm ignores
/// these contacts; or the algorithm is defined with one depth model only, which did not compute their depths.
void warn_of_fixed_stages(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  const RenderingConfig& fixed = scenario.rendering;
  const AlgorithmEntry& entry = *find_algorithm(fixed.algorithm);
  const std::string depth_model = json.value("rendering", Json::object()).value("depth_model", fixed.depth_model);
  if (!std::holds_alternative<SpringsEnvironment>(scenario.environment) && depth_model != fixed.depth_model) {
    warnings.push_back({kNoEffect, "/rendering/depth_model",
                        fmt::format("\"{}\" is not used: algorithm \"{}\" requires \"{}\"", depth_model,
                                    fixed.algorithm, fixed.depth_model)});
  }
  if (has_external_contacts(scenario) && !entry.reported_depth_model.empty()) {
    warnings.push_back(
        {"other_contacts", "/rendering/contact_source",
         fmt::format(
             "not used: algorithm \"{}\" finds its contacts itself: force and metrics belong to contacts with the "
             "points of the surface",
             fixed.algorithm)});
  } else if (has_external_contacts(scenario) && !entry.fixed_depth_model.empty()) {
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

/// Warns about an integrator other than the default if the device has no virtual mass to integrate.
void warn_of_idle_integrator(const Scenario& scenario, std::vector<Warning>& warnings) {
  if (!handle_moves_tool(scenario.device) || scenario.integrator.type == IntegratorFields{}.type) return;
  warnings.push_back(
      {kNoEffect, "/integrator/type",
       fmt::format(
           "\"{}\" is not used: with device \"impedance\" the handle moves the tool, and no virtual mass is integrated",
           scenario.integrator.type->info.name)});
}

/// Warns about an admittance device if the force of the hand does not depend on the handle's motion, because the
/// device's servo and mechanics then have no effect. Does not warn if only fields of the sensor and the limiter differ
/// from the defaults, because these fields always have an effect.
void warn_of_idle_device(const Scenario& scenario, std::vector<Warning>& warnings) {
  const char* hand = std::holds_alternative<NoHandFields>(scenario.hand)      ? "none"
                     : std::holds_alternative<ForceHandFields>(scenario.hand) ? "force"
                                                                              : "push";
  const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  if (reacts_to_handle(scenario.hand) || device == nullptr) return;
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

/// Warns about numbers of a device that are outside the range of haptic devices and probably have a wrong unit.
/// `hapbench import device` has the same limits of the handle's mass and of the encoder step, for numbers that it
/// identifies from the log of a device.
void warn_of_unlikely_device(const Scenario& scenario, std::vector<Warning>& warnings) {
  // Smallest and largest mass of a handle and of a carriage [kg].
  constexpr std::pair kHandles{1e-3, 20.0}, kCarriages{1e-3, 100.0};
  constexpr double kCoarsestEncoder = 1e-3, kLargestNoise = 1e-3;  // encoder step and position noise [m]
  // Coulomb friction [N], viscous friction [N s/m].
  constexpr double kLargestFriction = 100.0, kLargestViscosity = 1000.0;
  constexpr double kLongestDelay = 0.2;  // delay [s]
  const auto check = [&](const char* field, double value, std::pair<double, double> usual, const char* unit,
                         const char* question) {
    if (value == 0.0 || (value >= usual.first && value <= usual.second)) return;
    const std::string range = usual.first > 0.0 ? fmt::format("{:g} ... {:g}", usual.first, usual.second)
                                                : fmt::format("at most {:g}", usual.second);
    warnings.push_back(
        {"device_units", field,
         fmt::format("{:.6g} {}; haptic devices have {} {}: is the value in {}?", value, unit, range, unit, question)});
  };
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    check("/device/handle_mass_kg", device->handle_mass, kHandles, "kg", "kg");
    check("/device/encoder_step_m", device->encoder_step, {0.0, kCoarsestEncoder}, "m", "metres");
    check("/device/position_noise_m", device->position_noise, {0.0, kLargestNoise}, "m", "metres");
    check("/device/coulomb_N", device->coulomb, {0.0, kLargestFriction}, "N", "newtons");
    check("/device/viscous_N_s_per_m", device->viscous, {0.0, kLargestViscosity}, "N s/m", "N s/m");
    const bool in_seconds = device->delay.has_value();
    check(in_seconds ? "/device/delay_s" : "/device/delay_samples", device->delay_samples * scenario.time.step,
          {0.0, kLongestDelay}, "s", in_seconds ? "seconds" : "time steps");
  } else if (const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device)) {
    check("/device/mechanics/handle_mass_kg", admittance->mechanics.handle_mass, kHandles, "kg", "kg");
    check("/device/mechanics/carriage_mass_kg", admittance->mechanics.carriage_mass, kCarriages, "kg", "kg");
  }
}

/// Returns true if the algorithm documents the field as one of its parameters.
bool reads(const AlgorithmEntry& algorithm, std::string_view field) {
  const auto is_field = [field](const ParameterInfo& info) { return info.parameter.field == field; };
  return std::ranges::any_of(algorithm.info->parameters, is_field);
}

/// Warns about a damping and a filter that have no effect. `is_given`: returns true if the file sets the field at a
/// JSON pointer to another value than the default.
void warn_of_unread_damping(const Scenario& scenario, const std::function<bool(const std::string&)>& is_given,
                            std::vector<Warning>& warnings) {
  for (const char* pointer : {"/rendering/damping_ratio", "/rendering/damping_N_s_per_m"}) {
    if (scenario.rendering.hunt_crossley && is_given(pointer))
      warnings.push_back({kNoEffect, pointer, "has no effect together with rendering.damping"});
  }
  if (scenario.rendering.damping && !scenario.rendering.hunt_crossley && is_given("/rendering/damping_ratio"))
    warnings.push_back({kNoEffect, "/rendering/damping_ratio",
                        "has no effect together with rendering.damping_N_s_per_m, which replaces it"});
  constexpr const char* kCutoff = "/rendering/angular_velocity_cutoff_Hz";
  if (is_given(kCutoff) && !scenario.rendering.angular_damping)
    warnings.push_back({kNoEffect, kCutoff, "has no effect without rendering.angular_damping"});
}

/// Warns about values in `json` that differ from the defaults and that the rendering does not use: parameters of
/// other algorithms, damping that rendering.damping replaces, and the filter of an unused angular velocity.
void warn_of_unread_rendering(const Scenario& scenario, const Json& json, std::vector<Warning>& warnings) {
  // Collect the parameters that the scenario's algorithm does not use but another algorithm does.
  const AlgorithmEntry& own = *find_algorithm(scenario.rendering.algorithm);
  const Json initial = {{"rendering", written_object(RenderingConfig{})}};
  // Maps the JSON pointer of a field to the names of the algorithms that use the field.
  std::map<std::string, std::vector<std::string>> readers;
  for (const AlgorithmEntry& other : algorithms()) {
    for (const ParameterInfo& info : other.info->parameters) {
      if (reads(own, info.parameter.field)) continue;
      std::string pointer = "/" + std::string(info.parameter.field);
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      readers[pointer].emplace_back(other.info->name);
    }
    if (&other == &own) continue;
    for (const AlgorithmParameter& parameter : other.algorithm_parameters)
      readers[fmt::format("/rendering/parameters/{}/{}", other.info->name, parameter.name)] = {other.info->name};
  }
  // Warn about the collected parameters that the file sets to another value than the default.
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
  warn_of_unread_damping(scenario, is_given, warnings);
}

/// Warns if the bristle (tangential spring and damper) of dry friction is unstable at this time step and mass.
/// Then a sticking tool never comes to rest.
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

/// Searches `json` for scripts of waypoints and returns a warning about the first script that moves on after the end of
/// the run by more than a tenth of the run. Returns nullopt if `json` has no such script. `at` is the JSON pointer of
/// `json`; `duration` is the length of the run [s]. Precondition: the fields of `json` are valid.
std::optional<Warning> first_unplayed(const Json& json, const std::string& at, double duration) {
  constexpr double kUnplayed = 0.1;
  if (!json.is_object()) return std::nullopt;
  if (json.value("type", Json()) == "waypoints") {
    const Json& points = json.at("points");
    // Leave out waypoints at the end with which the script only holds its last value.
    std::size_t last = points.size() - 1;
    while (last > 0 && points[last - 1][1] == points[last][1]) --last;
    if (last == 0 || points[last][0].get<double>() <= (1.0 + kUnplayed) * duration) return std::nullopt;
    return Warning{"unplayed_script", at,
                   fmt::format("the script's last waypoint is at {:.6g} s, but the run ends at {:.6g} s; is "
                               "time.duration_s (or steps) right?",
                               points[last][0].get<double>(), duration)};
  }
  // Search the fields of any other object.
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
  warn_of_unlikely_device(scenario, warnings);
  warn_of_unread_rendering(scenario, json, warnings);
  warn_of_stiff_bristle(scenario, warnings);
  // Warn about a script of the hand or the motion that is not played to its end.
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  for (const char* part : {"hand", "motion"}) {
    if (!json.contains(part)) continue;
    if (auto found = first_unplayed(json.at(part), fmt::format("/{}", part), duration)) warnings.push_back(*found);
  }
  return warnings;
}

}  // namespace hapbench
