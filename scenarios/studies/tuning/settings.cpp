#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/studies/stability/field_limit.hpp"
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

}  // namespace hapbench
