#include "scenarios/analysis/tuning/family.hpp"

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

std::vector<FamilyMember> hands_of(const Scenario& scenario) {
  const bool has_mass = std::holds_alternative<MassSpringDamperHandFields>(scenario.hand);
  if (!has_mass && spring_of(scenario.hand) == nullptr && !std::holds_alternative<DragHandFields>(scenario.hand))
    return {};
  const auto family = hand_family().subspan(1);  // the first is not a hand
  const auto [soft, stiff] = std::ranges::minmax(family, {}, &AttachedHand::stiffness);
  const auto [light, heavy] = std::ranges::minmax(family, {}, &AttachedHand::mass);
  std::vector<FamilyMember> hands;
  for (const double k : {soft.stiffness, stiff.stiffness}) {
    const std::string spring = fmt::format("hand.stiffness_N_per_m={}", k);
    if (!has_mass) hands.push_back({fmt::format("a hand of {} N/m", k), {spring}});
    for (const double m : {light.mass, heavy.mass})
      if (has_mass)
        hands.push_back({fmt::format("a hand of {} kg and {} N/m", m, k), {spring, fmt::format("hand.mass_kg={}", m)}});
  }
  return hands;
}

std::vector<FamilyMember> seeds_of(const LoadedScenario& loaded) {
  constexpr std::size_t kSeeds = 5;    // the scene's own among them
  constexpr double kSeedShift = 1e-5;  // [m]
  const Axis axis = seed_axis(loaded.scenario, kSeeds, kSeedShift);
  std::vector<FamilyMember> seeds;
  for (std::size_t k = 1; k < kSeeds; ++k)
    seeds.push_back({"seed " + axis.values[k], {"seed=" + axis.values[k], axis.along[k].overrides.front()}});
  return seeds;
}

/// Scales the speed of everything in the JSON of a hand or a motion by a factor.
void scale_speed(Json& json, double times) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if (value.is_number() && (key == "speed_m_per_s" || key == "rate_per_s")) value = value.get<double>() * times;
    if (value.is_number() && key == "period_s") value = value.get<double>() / times;
    if (key == "points" && value.is_array()) {
      for (Json& point : value) point[0] = point[0].get<double>() / times;
    } else {
      scale_speed(value, times);
    }
  }
}

std::vector<FamilyMember> speeds_of(const LoadedScenario& loaded) {
  std::vector<FamilyMember> speeds;
  const Json own = effective_scenario(loaded.scenario, loaded.scenario.directory);
  for (const double times : {0.5, 2.0}) {
    FamilyMember member{times < 1.0 ? "half the speed" : "twice the speed"};
    for (const char* section : {"hand", "motion"}) {
      Json json = own.value(section, Json());
      scale_speed(json, times);
      if (json != own.value(section, Json())) member.overrides.push_back(fmt::format("{}={}", section, json.dump()));
    }
    if (member.overrides.empty()) return {};
    member.overrides.push_back(
        fmt::format("time.steps={:.0f}", static_cast<double>(loaded.scenario.time.steps) / times));
    speeds.push_back(std::move(member));
  }
  return speeds;
}

}  // namespace

std::vector<FamilyMember> family_of(const LoadedScenario& loaded, const std::string& family) {
  if (family == "hands") return hands_of(loaded.scenario);
  return family == "seeds" ? seeds_of(loaded) : speeds_of(loaded);
}

}  // namespace hapbench
