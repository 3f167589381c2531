#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/studies/tuning/tune.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr const char* kTunedField = "rendering.stiffness_N_per_m";
constexpr const char* kFilters[] = {R"({"type":"difference"})", R"({"type":"low_pass","cutoff_Hz":50})",
                                    R"({"type":"low_pass","cutoff_Hz":100})", R"({"type":"low_pass","cutoff_Hz":200})",
                                    R"({"type":"adaptive_window"})"};

const ImpedanceDeviceConfig* impedance_of(const Scenario& scenario) {
  return std::get_if<ImpedanceDeviceConfig>(&scenario.device);
}

}  // namespace

std::vector<std::string> overrides_of(const TuneSetting& setting, double stiffness) {
  std::vector<std::string> all;
  if (setting.damping_ratio) {
    all.push_back("rendering.damping_N_s_per_m=null");
    all.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
  }
  if (setting.mass) all.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
  if (!setting.filter.empty()) all.push_back("device.velocity_filter=" + setting.filter);
  all.push_back(fmt::format("{}={}", kTunedField, stiffness));
  return all;
}

std::string setting_text(const TuneSetting& setting) {
  std::string text;
  if (setting.damping_ratio) text += fmt::format(", zeta = {:.3g}", *setting.damping_ratio);
  if (setting.mass) text += fmt::format(", {:.3g} kg", *setting.mass);
  return setting.filter.empty() ? text : text + ", " + setting.filter;
}

TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm) {
  std::vector<std::string> overrides = question.overrides;
  overrides.push_back("rendering.algorithm=" + algorithm);
  TuneRanges ranges;
  ranges.stiffness = limit_question(question.scenario, overrides, kTunedField, {}).range;
  const Scenario own = load_scenario(question.scenario, overrides).scenario;
  if (!own.rendering.hunt_crossley) {
    ranges.damping_ratio = question.damping_ratio;
    ranges.damping_ratio->logarithmic = true;
    // zeta is that of the virtual mass; what moves is the handle.
    if (const auto* device = impedance_of(own)) {
      const double scale = std::sqrt(device->handle_mass / own.rendering.mass);
      ranges.damping_ratio->from *= scale;
      ranges.damping_ratio->to *= scale;
    }
  }
  if (std::holds_alternative<AdmittanceDeviceConfig>(own.device))
    ranges.mass = question.mass.value_or(Range{0.5 * own.rendering.mass, 2.0 * own.rendering.mass, true});
  return ranges;
}

std::vector<TuneSetting> settings_of(const TuneQuestion& question, const TuneRanges& ranges, const Scenario& own) {
  std::vector<std::optional<double>> ratios = {std::nullopt};
  if (ranges.damping_ratio) {
    const auto [from, to, logarithmic] = *ranges.damping_ratio;
    ratios = {std::clamp(own.rendering.damping_ratio, from, to)};
    const int parts = std::max(1, static_cast<int>(std::round(4.0 * math::log(to / from) / math::log(10.0))));
    for (int i = 0; i <= parts; ++i)
      ratios.emplace_back(ranges.damping_ratio->value_at(static_cast<double>(i) / parts));
  }
  std::vector<std::optional<double>> masses = {std::nullopt};
  if (ranges.mass) {
    const auto [from, to, logarithmic] = *ranges.mass;
    masses = {std::clamp(own.rendering.mass, from, to), from, to};
  }
  std::vector<std::string> filters = {""};
  if (question.filters && impedance_of(own) != nullptr)
    filters.insert(filters.end(), std::begin(kFilters), std::end(kFilters));
  std::vector<TuneSetting> settings;
  for (const std::string& filter : filters)
    for (const auto& mass : masses)
      for (const auto& ratio : ratios) settings.push_back({ratio, mass, filter});
  return settings;
}

namespace {

std::vector<FamilyMember> hands_of(const Scenario& scenario) {
  const bool has_mass = std::holds_alternative<MassSpringDamperHandFields>(scenario.hand);
  if (!has_mass && spring_of(scenario.hand) == nullptr && !std::holds_alternative<DragHandFields>(scenario.hand))
    return {};
  const auto family = hand_family().subspan(1);  // the first is no hand
  const auto [soft, stiff] = std::ranges::minmax(family, {}, &AttachedHand::stiffness);
  const auto [light, heavy] = std::ranges::minmax(family, {}, &AttachedHand::mass);
  std::vector<FamilyMember> hands;
  for (const double k : {soft.stiffness, stiff.stiffness}) {
    const std::string spring = fmt::format("hand.stiffness_N_per_m={}", k);
    if (!has_mass) hands.push_back({fmt::format("a hand of {} N/m", k), {spring}});
    for (const double m : {light.mass, heavy.mass}) {
      if (has_mass)
        hands.push_back({fmt::format("a hand of {} kg and {} N/m", m, k), {spring, fmt::format("hand.mass_kg={}", m)}});
    }
  }
  return hands;
}

std::vector<FamilyMember> seeds_of(const LoadedScenario& loaded) {
  const Axis axis = seed_axis(loaded.scenario, kSeeds, kSeedShift);
  std::vector<FamilyMember> seeds;
  for (std::size_t k = 1; k < kSeeds; ++k)
    seeds.push_back({"seed " + axis.values[k], {"seed=" + axis.values[k], axis.along[k].overrides.front()}});
  return seeds;
}

/// Makes everything in the JSON of a hand or a motion so many times as fast.
void hasten(Json& json, double times) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if (value.is_number() && (key == "speed_m_per_s" || key == "rate_per_s")) value = value.get<double>() * times;
    if (value.is_number() && key == "period_s") value = value.get<double>() / times;
    if (key == "points" && value.is_array()) {
      for (Json& point : value) point[0] = point[0].get<double>() / times;
    } else {
      hasten(value, times);
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
      hasten(json, times);
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

std::vector<FamilyMember> family_of(const LoadedScenario& loaded, FamilyOver over) {
  if (over == FamilyOver::hands) return hands_of(loaded.scenario);
  return over == FamilyOver::seeds ? seeds_of(loaded) : speeds_of(loaded);
}

}  // namespace hapbench
