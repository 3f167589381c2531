#include "scenarios/analysis/tuning/tune_search.hpp"

#include <fmt/format.h>

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

/// Returns the initial settings. The scene's setting comes first, so that another setting is preferred only if it
/// allows a larger K.
std::vector<TuneSetting> settings_of(const TuneRanges& ranges, const Scenario& scene) {
  std::vector<std::optional<double>> ratios = {std::nullopt};
  if (ranges.damping_ratio) {
    const auto [from, to, logarithmic] = *ranges.damping_ratio;
    ratios = {std::clamp(scene.rendering.damping_ratio, from, to)};
    const int parts = std::max(1, static_cast<int>(std::round(4.0 * math::log(to / from) / math::log(10.0))));
    for (int i = 0; i <= parts; ++i)
      ratios.emplace_back(ranges.damping_ratio->value_at(static_cast<double>(i) / parts));
  }
  std::vector<std::optional<double>> masses = {std::nullopt};
  if (ranges.mass) {
    const auto [from, to, logarithmic] = *ranges.mass;
    masses = {std::clamp(scene.rendering.mass, from, to), from, to};
  }
  std::vector<TuneSetting> settings;
  for (const auto& mass : masses)
    for (const auto& ratio : ratios) settings.push_back({ratio, mass, ""});
  return settings;
}

/// Removes the values of a scan below its two highest neighbouring feasible values, so that the search continues there.
/// A single feasible value may be a chance, for example between two resonances. Does nothing if no two neighbours are
/// feasible.
void keep_highest_neighbours(EvaluatedParameters& scan) {
  for (auto high = std::prev(scan.end()); high != scan.begin(); --high) {
    if (const auto low = std::prev(high); high->second && low->second) {
      scan.erase(scan.begin(), low);
      return;
    }
  }
}

constexpr double kFinestRatio = 1.004;   // factor on zeta and mass at which refinement ends
constexpr double kFinestDescent = 1.01;  // factor on K, zeta and mass at which a descent ends

}  // namespace

double stricter(double value, const LimitEnd& end, double factor) {
  const double scaled = end.is_max == (value > 0.0) ? value / factor : value * factor;
  // A value of 0 has no multiple: return the next number.
  return value == 0.0 ? std::nextafter(value, end.is_max ? -1.0 : 1.0) : scaled;
}

TuneSearch::TuneSearch(Trials& trials) : trials_(trials) {
  const Scenario scene = trials.trial_runs().load({}, trials.ranges().stiffness.from).scenario;
  settings_ = settings_of(trials.ranges(), scene);
  if (trials.question().filters && handle_moves_tool(scene.device)) filters_ = kFilters;
}

std::optional<TuneTrial> TuneSearch::best() {
  search_settings();
  if (!best_) return best_;
  // Search velocity filters, then refine.
  for (const char* filter : filters_)
    for (const TuneSetting& setting : settings_)
      if (setting.mass == best_->setting.mass) improve({setting.damping_ratio, setting.mass, filter});
  refine();
  // A scan may have feasible values above the neighbours at which its search continued.
  for (const TuneTrial* known = trials_.stiffest_feasible(); known->stiffness > best_->stiffness;
       known = trials_.stiffest_feasible())
    continue_from(*known);
  // Evaluate the trial just above the best trial further, so that its violated limit is reported with the error of the
  // metric.
  if (beyond_.stiffness > 0.0) beyond_ = trials_.evaluated(beyond_, Need::excess);
  return best_;
}

std::optional<TuneTrial> TuneSearch::strictest(const LimitEnd& end) {
  const TuneLimits limits = trials_.limits();
  search_settings();
  if (!best_) return best_;
  trials_.begin_purpose("search for the strictest bound");
  const std::vector<TuneTrial> known = trials_.feasible_trials();
  // Each accepted trial tightens the limit. A trial that violates the limit in the run of the scene itself needs no
  // further runs.
  TuneTrial at = require_stricter(*best_, end);
  const auto accept = [&](const TuneTrial& trial) {
    const Range range = stiffnesses();
    const TuneTrial& next = trials_.trial_at(trial.setting, std::clamp(trial.stiffness, range.from, range.to));
    if (!next.feasible()) return false;
    at = require_stricter(next, end);
    return true;
  };
  for (const TuneTrial& trial : known) accept(trial);
  for (double ratio = math::pow(10.0, 0.25); ratio > kFinestDescent; ratio = std::sqrt(ratio))
    while (std::ranges::any_of(neighbours(at, ratio), accept)) {
    }
  trials_.change_limits(limits);
  return best_ = trials_.trial_at(at.setting, at.stiffness);
}

/// Sets one end of a limit so that only trials with a stricter value than the value of `trial` are feasible. Returns
/// the trial with the errors of its metrics.
TuneTrial TuneSearch::require_stricter(const TuneTrial& trial, const LimitEnd& end) {
  constexpr double kImprovement = 1.005;
  const TuneTrial exact =
      depends_on_sampled_depth(end.metric) ? trials_.with_errors(trial) : trials_.evaluated(trial, Need::all);
  TuneLimits limits = trials_.limits();
  limits.at(end) = stricter(*exact.kept(end), end, kImprovement);
  trials_.change_limits(std::move(limits));
  return exact;
}

/// Finds the best trial of the initial settings. If no initial setting is feasible, finds a feasible trial by finer
/// searches.
void TuneSearch::search_settings() {
  constexpr std::size_t kStarts = 3;  // number of descents, which start from different settings
  // Begin with the known feasible trials: a trial that was evaluated earlier in this search may be the only feasible
  // trial.
  best_.reset();
  if (const TuneTrial* known = trials_.stiffest_feasible()) continue_from(*known);
  for (const TuneSetting& setting : settings_) improve(setting);
  if (best_) return;
  trials_.begin_purpose("search in finer steps");
  for (const TuneSetting& setting : settings_) scan_finely(setting);
  for (const char* filter : filters_)
    for (const TuneSetting& setting : settings_)
      if (!best_) improve({setting.damping_ratio, setting.mass, filter});
  if (!best_) trials_.begin_purpose("search near the bounds");
  if (!best_)
    for (const TuneTrial* start : trials_.nearest(kStarts))
      if (!best_) approach(*start);
}

/// Makes a feasible trial the best trial, and searches above it.
void TuneSearch::continue_from(const TuneTrial& trial) {
  best_ = trial;
  beyond_ = {};
  beyond_.fail("range", "the end of the search range");
  improve(TuneSetting(best_->setting));
}

/// Searches for a feasible K of a setting between the stiffnesses of the scan, from the largest stiffness downwards. If
/// the run of the scene itself is settled at one end of an interval of the scan, evaluates the two stiffnesses that
/// divide this interval into thirds. Stops at the first feasible trial, and improves it.
void TuneSearch::scan_finely(const TuneSetting& setting) {
  constexpr int kParts = 3;
  if (best_) return;
  const IntervalSearchOptions options{.range = stiffnesses(), .resolution = kTuneResolution};
  const auto settled = [&](int i) {
    return trials_.trial_at(setting, options.value_at(static_cast<double>(i) / kScanIntervals)).settled;
  };
  for (int i = kScanIntervals - 1; i >= 0; --i) {
    if (!settled(i) && !settled(i + 1)) continue;
    for (int part = kParts - 1; part > 0; --part) {
      const double K = options.value_at((i + static_cast<double>(part) / kParts) / kScanIntervals);
      if (trials_.feasible(setting, K)) return static_cast<void>(improve(setting));
    }
  }
}

Range TuneSearch::stiffnesses() const {
  const Range& whole = trials_.ranges().stiffness;
  return {whole.from, whole.to / trials_.question().margin, true};
}

/// Searches for a feasible K of a setting above the best K so far. If there is a feasible K, makes the trial at the
/// largest K that the search finds the best trial and returns true.
bool TuneSearch::improve(const TuneSetting& setting) {
  // Search only above the best K.
  IntervalSearchOptions options{.range = stiffnesses(), .resolution = kTuneResolution};
  if (best_) {
    options.range.from = best_->stiffness * (1.0 + kTuneResolution);
    if (!(options.range.from < options.range.to)) return false;
    if (!trials_.feasible(setting, options.range.from)) {
      if (setting == best_->setting) beyond_ = trials_.trial_at(setting, options.range.from);
      return false;
    }
  }
  trials_.run_ahead(setting, scan_values(options, kScanIntervals));
  const auto holds = [&](double t) { return trials_.feasible(setting, options.value_at(t)); };
  EvaluatedParameters scan = evaluate_scan(kScanIntervals, holds);
  keep_highest_neighbours(scan);
  if (!best_) add_known(setting, options, scan);
  if (const auto between = window(setting, options, scan)) scan[*between] = true;
  const StableInterval interval = find_stable_interval(options, scan, holds, false);
  if (!interval.stable) return false;
  best_ = trials_.trial_at(setting, options.value_at(*interval.stable));
  // The interval may end at a known feasible stiffness (add_known()) that rounding has changed slightly. If the changed
  // stiffness is infeasible, use the largest stiffness that is known to be feasible.
  if (!best_->feasible()) best_ = trials_.trial_at(setting, trials_.feasible_stiffnesses(setting).back());
  trials_.begin_purpose(fmt::format("search above K = {:.3g} N/m", best_->stiffness));
  if (interval.beyond) {
    beyond_ = trials_.trial_at(setting, options.value_at(*interval.beyond));
  } else {
    beyond_ = {};
    beyond_.fail("range", "the end of the search range");
  }
  return true;
}

/// Adds the feasible trials of a setting, evaluated earlier in this search, to the values of the scan.
void TuneSearch::add_known(const TuneSetting& setting, const IntervalSearchOptions& options,
                           EvaluatedParameters& scan) const {
  const auto [from, to, logarithmic] = options.range;
  for (const double K : trials_.feasible_stiffnesses(setting))
    if (K >= from && K <= to) scan[std::clamp(math::log(K / from) / math::log(to / from), 0.0, 1.0)] = true;
}

bool TuneSearch::is_too_soft(const TuneSetting& setting, const IntervalSearchOptions& options, double t) {
  return trials_.is_too_soft(setting, options.value_at(t));
}

/// Searches between two neighbouring values of the scan, of which the lower is too soft and the upper too stiff.
/// Returns the parameter of a feasible value; empty if no feasible value is found.
std::optional<double> TuneSearch::window(const TuneSetting& setting, const IntervalSearchOptions& options,
                                         const EvaluatedParameters& scan) {
  for (auto at = scan.begin(); std::next(at) != scan.end(); ++at) {
    const auto next = std::next(at);
    if (at->second || !is_too_soft(setting, options, at->first)) continue;
    if (next->second || is_too_soft(setting, options, next->first)) continue;
    if (const auto found = feasible_between(setting, options, at->first, next->first)) return found;
  }
  return std::nullopt;
}

/// Bisects between a parameter that is too soft and a parameter that is too stiff. Returns the first feasible
/// parameter; empty if no feasible parameter is found.
std::optional<double> TuneSearch::feasible_between(const TuneSetting& setting, const IntervalSearchOptions& options,
                                                   double soft, double stiff) {
  while (options.needs_bisection(soft, stiff)) {
    const double middle = 0.5 * (soft + stiff);
    if (trials_.feasible(setting, options.value_at(middle))) return middle;
    if (is_too_soft(setting, options, middle))
      soft = middle;
    else
      stiff = middle;
  }
  return std::nullopt;
}

/// Refines zeta and mass of the best setting by a pattern search with decreasing factors.
void TuneSearch::refine() {
  const auto is_better = [this](const TuneTrial& neighbour) { return improve(neighbour.setting); };
  for (double ratio = math::pow(10.0, 0.125); ratio > kFinestRatio; ratio = std::sqrt(ratio))
    while (std::ranges::any_of(neighbours(*best_, ratio), is_better)) {
    }
}

/// Called if no trial is feasible. Starts from a trial that violates only limits, and reduces its excess() by a pattern
/// search until a trial is feasible.
void TuneSearch::approach(const TuneTrial& start) {
  const TuneTrial* at = &start;
  const auto is_better = [&](const TuneTrial& neighbour) {
    const Range range = stiffnesses();
    const double K = std::clamp(neighbour.stiffness, range.from, range.to);
    const TuneTrial& next = trials_.trial_at(neighbour.setting, K);
    if (next.feasible()) best_ = next;
    if (!best_ && !trials_.is_nearer(next, *at)) return false;
    at = &next;
    return true;
  };
  for (double ratio = math::pow(10.0, 0.25); ratio > kFinestDescent && !best_; ratio = std::sqrt(ratio))
    while (!best_ && std::ranges::any_of(neighbours(*at, ratio), is_better)) {
    }
  if (best_) improve(best_->setting);
}

/// Returns the neighbours of a trial: K, zeta or mass multiplied or divided by `ratio`, and other filters.
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
