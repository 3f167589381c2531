#include "scenarios/analysis/tuning/tune_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "scenarios/scene/scenario.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr const char* kFilters[] = {R"({"type":"difference"})", R"({"type":"low_pass","cutoff_Hz":50})",
                                    R"({"type":"low_pass","cutoff_Hz":100})", R"({"type":"low_pass","cutoff_Hz":200})",
                                    R"({"type":"adaptive_window"})"};

/// The settings to begin with, the scene's own first: with equal K it stays.
std::vector<TuneSetting> settings_of(const TuneRanges& ranges, const Scenario& own) {
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
  std::vector<TuneSetting> settings;
  for (const auto& mass : masses)
    for (const auto& ratio : ratios) settings.push_back({ratio, mass, ""});
  return settings;
}

constexpr double kFinest = 1.004;  // ratio of zeta, or of the mass, at which the search ends

}  // namespace

TuneSearch::TuneSearch(Trials& trials) : trials_(trials) {
  const Scenario own = trials.load({}, trials.ranges().stiffness.from).scenario;
  settings_ = settings_of(trials.ranges(), own);
  if (trials.question().filters && handle_moves_tool(own.device)) filters_ = kFilters;
}

std::optional<TuneTrial> TuneSearch::best() {
  best_.reset();
  for (const TuneSetting& setting : settings_) improve(setting);
  if (!best_) approach();
  if (!best_) return best_;
  for (const char* filter : filters_)
    for (const TuneSetting& setting : settings_)
      if (setting.mass == best_->setting.mass) improve({setting.damping_ratio, setting.mass, filter});
  refine();
  return best_;
}

Range TuneSearch::stiffnesses() const {
  const Range& whole = trials_.ranges().stiffness;
  return {whole.from, whole.to / trials_.question().margin, true};
}

/// Raises K at this setting if it can be raised beyond the best K. Returns true if it was raised.
bool TuneSearch::improve(const TuneSetting& setting) {
  SearchWay way{.range = stiffnesses(), .resolution = kTuneResolution};
  if (best_) {
    way.range.from = best_->stiffness * (1.0 + kTuneResolution);
    if (!(way.range.from < way.range.to)) return false;
    if (!trials_.feasible(setting, way.range.from)) {
      if (setting == best_->setting) beyond_ = trials_.beyond(setting, way.range.from);
      return false;
    }
  }
  const auto holds = [&](double t) { return trials_.feasible(setting, way.value_at(t)); };
  TriedParts scan = scanned(kEdgeIntervals, holds);
  if (const auto between = window(setting, way, scan)) scan[*between] = true;
  const FoundEdge edge = find_edge(way, scan, holds, false);
  if (!edge.stable) return false;
  best_ = trials_.tried(setting, way.value_at(*edge.stable));
  beyond_ = edge.beyond ? trials_.beyond(setting, way.value_at(*edge.beyond)) : trials_.end();
  return true;
}

bool TuneSearch::is_too_soft(const TuneSetting& setting, const SearchWay& way, double t) {
  return trials_.tried(setting, way.value_at(t)).too_soft;
}

/// Finds a feasible value between a value that is too soft and the next one, which is too stiff: the scan may step over
/// it.
std::optional<double> TuneSearch::window(const TuneSetting& setting, const SearchWay& way, const TriedParts& scan) {
  for (auto at = scan.begin(); std::next(at) != scan.end(); ++at) {
    const auto next = std::next(at);
    if (at->second || !is_too_soft(setting, way, at->first)) continue;
    if (next->second || is_too_soft(setting, way, next->first)) continue;
    if (const auto found = feasible_between(setting, way, at->first, next->first)) return found;
  }
  return std::nullopt;
}

/// Bisects between a parameter that is too soft and one that is too stiff, until one is feasible.
std::optional<double> TuneSearch::feasible_between(const TuneSetting& setting, const SearchWay& way, double soft,
                                                   double stiff) {
  while (way.apart(soft, stiff)) {
    const double middle = 0.5 * (soft + stiff);
    if (trials_.feasible(setting, way.value_at(middle))) return middle;
    if (is_too_soft(setting, way, middle))
      soft = middle;
    else
      stiff = middle;
  }
  return std::nullopt;
}

/// Refines the best setting in smaller and smaller ratios.
void TuneSearch::refine() {
  const auto is_better = [this](const TuneTrial& neighbour) { return improve(neighbour.setting); };
  for (double ratio = math::pow(10.0, 0.125); ratio > kFinest; ratio = std::sqrt(ratio))
    while (std::ranges::any_of(neighbours(*best_, ratio), is_better)) {
    }
}

/// If only limits are violated, walks from the trial that is nearest to keeping them all towards them.
void TuneSearch::approach() {
  const TuneTrial* at = trials_.nearest();
  if (at == nullptr) return;
  const auto is_better = [&](const TuneTrial& neighbour) {
    const Range range = stiffnesses();
    const double K = std::clamp(neighbour.stiffness, range.from, std::min(trials_.cap(), range.to));
    const TuneTrial& next = trials_.tried(neighbour.setting, K);
    if (next.feasible()) best_ = next;
    if (!best_ && !(next.limits_alone && trials_.excess(next) < trials_.excess(*at))) return false;
    at = &next;
    return true;
  };
  for (double ratio = math::pow(10.0, 0.25); ratio > kFinest && !best_; ratio = std::sqrt(ratio))
    while (!best_ && std::ranges::any_of(neighbours(*at, ratio), is_better)) {
    }
  if (best_) improve(best_->setting);
}

/// Returns the settings and stiffnesses around a trial: each of its numbers times and over the ratio, and other
/// filters.
std::vector<TuneTrial> TuneSearch::neighbours(const TuneTrial& trial, double ratio) const {
  std::vector<TuneTrial> all;
  const auto add_scaled = [&](std::optional<double> TuneSetting::*number, const std::optional<Range>& range,
                              double factor) {
    if (!range) return;
    TuneTrial& scaled = all.emplace_back(trial);
    scaled.setting.*number = std::clamp(*(trial.setting.*number) * factor, range->from, range->to);
  };
  for (const double factor : {ratio, 1.0 / ratio}) {
    all.emplace_back(trial).stiffness *= factor;
    add_scaled(&TuneSetting::damping_ratio, trials_.ranges().damping_ratio, factor);
    add_scaled(&TuneSetting::mass, trials_.ranges().mass, factor);
  }
  for (const char* filter : filters_) all.emplace_back(trial).setting.filter = filter;
  return all;
}

}  // namespace hapbench
