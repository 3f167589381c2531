#include "scenarios/analysis/tuning/scene_variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/batch/seed_axis.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

/// Returns the variants with soft and stiff hands; for a hand with a mass, also light and heavy hands.
std::vector<SceneVariant> hand_variants(const Scenario& scenario) {
  const bool has_mass = std::holds_alternative<MassSpringDamperHandFields>(scenario.hand);
  if (!has_mass && spring_of(scenario.hand) == nullptr && !std::holds_alternative<DragHandFields>(scenario.hand))
    return {};
  const auto family = typical_hands().subspan(1);  // the first entry is no hand
  const auto [soft, stiff] = std::ranges::minmax(family, {}, &AttachedHand::stiffness);
  const auto [light, heavy] = std::ranges::minmax(family, {}, &AttachedHand::mass);
  std::vector<SceneVariant> hands;
  for (const double k : {soft.stiffness, stiff.stiffness}) {
    const std::string spring = fmt::format("hand.stiffness_N_per_m={}", k);
    if (!has_mass) hands.push_back({fmt::format("a hand of {} N/m", k), {spring}});
    for (const double m : {light.mass, heavy.mass})
      if (has_mass)
        hands.push_back({fmt::format("a hand of {} kg and {} N/m", m, k), {spring, fmt::format("hand.mass_kg={}", m)}});
  }
  return hands;
}

/// Returns the variants with other seeds and slightly shifted starts.
std::vector<SceneVariant> seed_variants(const LoadedScenario& loaded) {
  constexpr std::size_t kSeeds = 5;    // number of seeds, including the scene's seed
  constexpr double kSeedShift = 1e-5;  // displacement of the start [m]
  const Axis axis = seed_axis(loaded.scenario, kSeeds, kSeedShift);
  std::vector<SceneVariant> seeds;
  for (std::size_t k = 1; k < kSeeds; ++k)
    seeds.push_back({"seed " + axis.values[k], {"seed=" + axis.values[k], axis.along[k].overrides.front()}});
  return seeds;
}

/// Multiplies all speeds and rates in the JSON of a hand or a motion by a factor, and divides periods and times by the
/// same factor.
void scale_speed(Json& json, double factor) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if (value.is_number() && (key == "speed_m_per_s" || key == "rate_per_s")) value = value.get<double>() * factor;
    if (value.is_number() && key == "period_s") value = value.get<double>() / factor;
    if (key == "points" && value.is_array()) {
      for (Json& point : value) point[0] = point[0].get<double>() / factor;
    } else {
      scale_speed(value, factor);
    }
  }
}

/// Returns the variants at half and twice the speed; empty if no script has a speed.
std::vector<SceneVariant> speed_variants(const LoadedScenario& loaded) {
  std::vector<SceneVariant> speeds;
  const Json own = effective_scenario(loaded.scenario, loaded.scenario.directory);
  for (const double factor : {0.5, 2.0}) {
    SceneVariant variant{factor < 1.0 ? "half the speed" : "twice the speed"};
    for (const char* section : {"hand", "motion"}) {
      Json json = own.value(section, Json());
      scale_speed(json, factor);
      if (json != own.value(section, Json())) variant.overrides.push_back(fmt::format("{}={}", section, json.dump()));
    }
    if (variant.overrides.empty()) return {};
    variant.overrides.push_back(
        fmt::format("time.steps={:.0f}", static_cast<double>(loaded.scenario.time.steps) / factor));
    speeds.push_back(std::move(variant));
  }
  return speeds;
}

}  // namespace

std::vector<SceneVariant> scene_variants(const LoadedScenario& loaded, const std::string& family) {
  if (family == "hands") return hand_variants(loaded.scenario);
  return family == "seeds" ? seed_variants(loaded) : speed_variants(loaded);
}

}  // namespace hapbench
