#include "scenarios/limits/tuning/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenarios/limits/tuning/trials.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
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
    if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&own.device)) {
      const double scale = std::sqrt(device->handle_mass / own.rendering.mass);
      ranges.damping_ratio->from *= scale;
      ranges.damping_ratio->to *= scale;
    }
  }
  if (std::holds_alternative<AdmittanceDeviceConfig>(own.device))
    ranges.mass = question.mass.value_or(Range{0.5 * own.rendering.mass, 2.0 * own.rendering.mass, true});
  return ranges;
}

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

/// Searches the settings of a law for the largest feasible K.
class TuneSearch {
 public:
  explicit TuneSearch(Trials& trials) : trials_(trials) {
    const Scenario own = trials.load({}, trials.ranges.stiffness.from, {}).scenario;
    settings_ = settings_of(trials.ranges, own);
    if (trials.question.filters && handle_moves_tool(own.device)) filters_ = kFilters;
  }

  /// The best trial; empty where nothing is feasible.
  std::optional<TuneTrial> best() {
    best_.reset();
    for (const TuneSetting& setting : settings_) improve(setting);
    if (!best_) approach();
    if (!best_) return best_;
    for (const char* filter : filters_) {
      for (const TuneSetting& setting : settings_)
        if (setting.mass == best_->mass) improve({setting.damping_ratio, setting.mass, filter});
    }
    refine();
    return best_;
  }
  /// The trial just beyond the best.
  const TuneTrial& beyond() const { return beyond_; }

 private:
  Range stiffnesses() const {
    const Range& whole = trials_.ranges.stiffness;
    return {whole.from, whole.to / trials_.question.margin, true};
  }

  /// Raises K at this setting if it can be raised beyond the best; true if it was.
  bool improve(const TuneSetting& setting) {
    SearchWay way{.range = stiffnesses(), .resolution = kTuneResolution};
    if (best_) {
      way.range.from = best_->stiffness * (1.0 + kTuneResolution);
      if (!(way.range.from < way.range.to)) return false;
      if (!trials_.feasible(setting, way.range.from)) {
        if (setting == *best_) beyond_ = trials_.beyond(setting, way.range.from);
        return false;
      }
    }
    const auto holds = [&](double part) { return trials_.feasible(setting, way.value_at(part)); };
    std::map<double, bool> scan = scanned(kEdgeIntervals, holds);
    if (const auto between = window(setting, way, scan)) scan[*between] = true;
    const FoundEdge edge = find_edge(way, scan, holds, false);
    if (!edge.stable) return false;
    best_ = trials_.tried(setting, way.value_at(*edge.stable));
    beyond_ = edge.beyond ? trials_.beyond(setting, way.value_at(*edge.beyond)) : trials_.end;
    return true;
  }

  /// Where no value of a scan is feasible: one between those that are too soft and those that are too stiff.
  std::optional<double> window(const TuneSetting& setting, const SearchWay& way, const std::map<double, bool>& scan) {
    const auto soft = [&](double part) { return trials_.tried(setting, way.value_at(part)).too_soft; };
    for (auto at = scan.begin(); std::next(at) != scan.end(); ++at) {
      if (at->second || !soft(at->first) || std::next(at)->second || soft(std::next(at)->first)) continue;
      double low = at->first, high = std::next(at)->first;
      while (way.apart(low, high)) {
        const double middle = 0.5 * (low + high);
        if (trials_.feasible(setting, way.value_at(middle))) return middle;
        (soft(middle) ? low : high) = middle;
      }
    }
    return std::nullopt;
  }

  void refine() {
    const auto is_better = [this](const TuneTrial& neighbour) { return improve(neighbour); };
    for (double ratio = math::pow(10.0, 0.125); ratio > kFinest; ratio = std::sqrt(ratio))
      while (std::ranges::any_of(neighbours(*best_, ratio), is_better)) {
      }
  }

  /// Where only limits are not kept, walks from the trial that is nearest to keeping them all towards them.
  void approach() {
    const TuneTrial* at = trials_.nearest();
    if (at == nullptr) return;
    const auto is_better = [&](const TuneTrial& neighbour) {
      const Range range = stiffnesses();
      const double K = std::clamp(neighbour.stiffness, range.from, std::min(trials_.cap, range.to));
      const TuneTrial& next = trials_.tried(neighbour, K);
      if (next.feasible()) best_ = next;
      if (!best_ && !(next.limits_alone && trials_.excess(next) < trials_.excess(*at))) return false;
      at = &next;
      return true;
    };
    for (double ratio = math::pow(10.0, 0.25); ratio > kFinest && !best_; ratio = std::sqrt(ratio))
      while (!best_ && std::ranges::any_of(neighbours(*at, ratio), is_better)) {
      }
    if (best_) improve(*best_);
  }

  /// The settings and stiffnesses around a trial: each of its numbers times and over the ratio, and other filters.
  std::vector<TuneTrial> neighbours(const TuneTrial& trial, double ratio) const {
    std::vector<TuneTrial> all;
    for (const double times : {ratio, 1.0 / ratio}) {
      all.push_back(trial);
      all.back().stiffness *= times;
      for (const auto& [value, range] : searched()) {
        if (!range) continue;
        all.push_back(trial);
        all.back().*value = std::clamp(*(trial.*value) * times, range->from, range->to);
      }
    }
    for (const char* filter : filters_) {
      all.push_back(trial);
      all.back().filter = filter;
    }
    return all;
  }

  using Searched = std::pair<std::optional<double> TuneSetting::*, std::optional<Range>>;
  std::array<Searched, 2> searched() const {
    return {{{&TuneSetting::damping_ratio, trials_.ranges.damping_ratio}, {&TuneSetting::mass, trials_.ranges.mass}}};
  }

  Trials& trials_;
  std::vector<TuneSetting> settings_;
  std::span<const char* const> filters_;  ///< that are also searched
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;
};

/// Trials from a thirtieth of the choice's stiffness to thirty times, for pictures.
void try_along_stiffness(Trials& trials, const TuneTrial& choice) {
  const Range around{choice.stiffness / 30.0, choice.stiffness * 30.0, true}, whole = trials.ranges.stiffness;
  for (int i = 0; i <= kEdgeIntervals; ++i) {
    const double K = around.value_at(static_cast<double>(i) / kEdgeIntervals);
    if (!(K > whole.from && K < whole.to / trials.question.margin)) continue;
    TuneTrial& trial = trials.tried(choice, K);
    if (trial.settled) trials.measure(trial);
  }
}

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  TunedLaw law;
  law.algorithm = algorithm;
  Trials trials(question, algorithm);
  TuneSearch search(trials);
  do {
    law.choice = search.best();
  } while (law.choice && is_refuted(trials, *law.choice, law));
  if (law.choice) {
    law.binding = search.beyond().binding;
    law.why = search.beyond().why;
    law.margins = margins_of(trials, *law.choice);
    law.overrides = trials.overrides(*law.choice, law.choice->stiffness);
    try_along_stiffness(trials, *law.choice);
  } else {
    explain(trials, law);
  }
  for (const auto& [key, trial] : trials.all) law.trials.push_back(trial);
  law.runs = trials.runs;
  return law;
}

}  // namespace hapbench
