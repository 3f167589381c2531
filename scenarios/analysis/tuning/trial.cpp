#include "scenarios/analysis/tuning/trial.hpp"

#include <fmt/format.h>

#include <utility>

namespace hapbench {

std::optional<double> value_in(const MetricValues& metrics, std::string_view name, double factor) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(factor * found->second);
}

std::string setting_text(const TuneSetting& setting) {
  std::string text;
  if (setting.damping_ratio)
    text += fmt::format(", zeta = {:.3g} relative to rendering.mass_kg", *setting.damping_ratio);
  if (setting.mass) text += fmt::format(", {:.3g} kg", *setting.mass);
  return setting.filter.empty() ? text : text + ", " + setting.filter;
}

const ExtremeValue* TuneTrial::extreme(const LimitEnd& end) const {
  const auto& extremes = end.is_max ? largest : smallest;
  const auto found = extremes.find(end.metric);
  return found == extremes.end() ? nullptr : &found->second;
}

std::optional<double> TuneTrial::kept(const LimitEnd& end) const {
  const ExtremeValue* found = extreme(end);
  if (found == nullptr) return std::nullopt;
  const double within = value_in(error, end.metric).value_or(0.0);
  return end.is_max ? found->value + within : found->value - within;
}

void TuneTrial::fail(std::string constraint, std::string reason) {
  binding = std::move(constraint);
  why = std::move(reason);
}

}  // namespace hapbench
