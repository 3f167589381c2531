#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "scenarios/analysis/convergence/convergence.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/run_all.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm) {
  std::vector<std::string> overrides = question.overrides;
  overrides.push_back("rendering.algorithm=" + algorithm);
  TuneRanges ranges;
  ranges.stiffness = limit_question(question.scenario, overrides, kStiffnessPath, {}).search.range;
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

constexpr double kTuneResolution = 5e-3;  // of K

// ---- The search

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
    for (const char* filter : filters_)
      for (const TuneSetting& setting : settings_)
        if (setting.mass == best_->mass) improve({setting.damping_ratio, setting.mass, filter});
    refine();
    return best_;
  }
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
    TriedParts scan = scanned(kEdgeIntervals, holds);
    if (const auto between = window(setting, way, scan)) scan[*between] = true;
    const FoundEdge edge = find_edge(way, scan, holds, false);
    if (!edge.stable) return false;
    best_ = trials_.tried(setting, way.value_at(*edge.stable));
    beyond_ = edge.beyond ? trials_.beyond(setting, way.value_at(*edge.beyond)) : trials_.end;
    return true;
  }

  /// Where no value of a scan is feasible: one between those that are too soft and those that are too stiff.
  std::optional<double> window(const TuneSetting& setting, const SearchWay& way, const TriedParts& scan) {
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
      for (const auto& [value, range] : {std::pair(&TuneSetting::damping_ratio, trials_.ranges.damping_ratio),
                                         {&TuneSetting::mass, trials_.ranges.mass}}) {
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

// ---- A choice is checked before it is recommended: between the values tried, in longer runs and up to its margins.

constexpr double kMuchLess = 1.25;  // of K, that is given up where a choice does not hold for longer

/// The override for K times a factor.
std::string with_gain(const TuneTrial& trial, double gain) {
  return fmt::format("{}={}", kStiffnessPath, gain * trial.stiffness);
}

/// Nothing is tried any more that reaches K, which is not settled, within its margin.
bool refute(Trials& trials, const TuneTrial& choice, double K, const std::string& why) {
  trials.refuted = std::min(trials.refuted, K);
  trials.cap = K / trials.question.margin * (1.0 - kTuneResolution);
  trials.end.fail("margin", fmt::format("at {:.4g} N/m{} {}", K, setting_text(choice), why));
  return true;
}

bool fails_between(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const SearchWay gains{.range = {1.0, trials.question.margin, true}};
  std::vector<double> parts = parts_between(0.0, 1.0, kTriedBetween);
  const std::vector<double> near = parts_below(gains, 1.0);
  parts.insert(parts.end(), near.begin(), near.end());
  const auto at_part = [&](std::size_t i) { return with_gain(choice, gains.value_at(parts[i])); };
  if (const auto failing = trials.first_failing(choice, parts.size(), at_part))
    return refute(trials, choice, choice.stiffness * gains.value_at(parts[failing->run]), failing->why);
  law.verified = parts.size();
  return false;
}

/// Finds the edges of K in the scene as chosen; true where the own run has one before G K.
bool own_edge_is_near(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const ScenarioText& scene = trials.question.scenario;
  const std::vector<std::string> chosen = trials.overrides(choice, choice.stiffness);
  LimitQuestion question = limit_question(scene, chosen, kStiffnessPath, {});
  question.rule = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question.threads;
  law.edge = field_limit(question);
  trials.runs += law.edge.runs.size();
  const double G_K = trials.question.margin * choice.stiffness;
  if (!law.edge.end.value) return refute(trials, choice, G_K, "stable values are scattered");
  if (!law.edge.end.beyond) return false;
  const auto& [K, verdict] = *law.edge.end.beyond;
  if (K < G_K) return refute(trials, choice, K, std::string(run_verdict_name(verdict)));
  trials.refuted = std::min(trials.refuted, K);
  return false;
}

bool fails_later(Trials& trials, const TuneTrial& choice) {
  const Scenario own = trials.load(choice, choice.stiffness, trials.family[0]).scenario;
  const double duration = own.time.step * static_cast<double>(own.time.steps);
  // A script that leads on comes to places that the scene does not ask for.
  if (script_moves_until(own) > duration && script_period(own) == 0.0) return false;
  const auto twice = [&](std::size_t) { return fmt::format("time.steps={}", 2 * own.time.steps); };
  const auto failing = trials.first_failing(choice, trials.family.size(), twice);
  if (!failing) return false;
  trials.cap = choice.stiffness / kMuchLess;
  trials.end.fail("settled", fmt::format("at {:.4g} N/m{} in a run twice as long {}", choice.stiffness,
                                         setting_text(choice), failing->why));
  return true;
}

/// TunedLaw::error of a trial.
TuneMetrics known_errors(Trials& trials, const TuneTrial& trial) {
  const ScenarioText& scene = trials.question.scenario;
  const std::vector<std::string> chosen = trials.overrides(trial, trial.stiffness);
  const LoadedScenario own = load_scenario(scene, chosen);
  const Cases once({scene}, chosen, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(own, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(own)) {
    finer.push_back(finer_cases(level_sweep(own, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, chosen, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  trials.runs += finer.size();
  const std::vector<Result> runs = run_all(finer, {trials.question.threads, ""});
  TuneMetrics error;
  for (const auto& [name, value] : trial.metrics) {
    double most = 0.0;
    for (const Result& run : runs) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      most = std::max(most, std::abs(moved - value));
    }
    if (std::isfinite(most)) error[name] = most;
  }
  return error;
}

/// True where a limit of the user is not kept by as much as the metric's error. Then less is allowed.
bool is_beyond_limits(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  trials.measure(choice);
  law.error = trials.error = known_errors(trials, choice);
  bool beyond = false;
  for (const auto& [name, bound] : trials.question.limits) {
    const auto worst = value_in(choice.worst, name), error = value_in(law.error, name);
    if (!worst || !error) continue;
    MetricBound& allowed = trials.limits[name];
    if (bound.max && *worst + *error > *bound.max) {
      allowed.max = std::min(*allowed.max * (1.0 - kTuneResolution), std::max(*bound.max - *error, 0.0));
      beyond = true;
    }
    if (bound.min && *worst - *error < *bound.min) {
      allowed.min = *bound.min + *error;
      beyond = true;
    }
  }
  for (auto& [key, trial] : trials.all)
    if (beyond && (trial.limits_alone || trial.feasible())) trials.judge_worst(trial);
  return beyond;
}

/// kTriedBetween parts before the last, of delays also each quarter of a sample; of whole numbers all.
std::vector<double> parts_up_to(const SearchWay& way, double last) {
  std::vector<double> parts;
  if (!way.whole) parts = parts_between(0.0, last, kTriedBetween);
  const double step = way.range.logarithmic ? 1.0 : (way.whole ? 1.0 : 0.25) / (way.range.to - way.range.from);
  for (double part = step; part < last; part += step) parts.push_back(part);
  return parts;
}

/// The last value of a way up to which the trial is settled under its override, also at values between.
double last_settled(Trials& trials, const TuneTrial& trial, const SearchWay& way,
                    const std::function<std::string(double value)>& override_of) {
  const auto holds = [&](double part) {
    const auto with_part = [&](std::size_t) { return override_of(way.value_at(part)); };
    return !trials.first_failing(trial, trials.family.size(), with_part);
  };
  bool so_far = true;  // a run beyond the first edge tells nothing
  TriedParts tried = scanned(kEdgeIntervals, [&](double part) { return so_far = so_far && holds(part); });
  while (true) {
    const double last = find_edge(way, tried, holds, false).stable.value_or(0.0);
    const std::vector<double> parts = parts_up_to(way, last);
    const auto at_part = [&](std::size_t i) { return override_of(way.value_at(parts[i])); };
    const auto failing = trials.first_failing(trial, parts.size(), at_part);
    if (!failing) return way.value_at(last);
    tried[parts[failing->run]] = false;
  }
}

/// The damping ratio of the least damped mode of the loop in contact; empty where there is no loop.
std::optional<double> least_damping_ratio(const Scenario& scenario, double lambda, bool over_hands) {
  std::optional<double> least;
  if (!(lambda > 0.0)) return least;
  for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands)) {
    for (const std::complex<double>& z : eigenvalues(step)) {
      const double size = math::hypot(z.real(), z.imag());
      if (size < 1e-9) continue;  // a delay line
      const double decay = -math::log(size), ratio = decay / math::hypot(decay, math::atan2(z.imag(), z.real()));
      if (decay != 0.0) least = std::min(least.value_or(1.0), ratio);
    }
  }
  return least;
}

TuneMargins margins_of(Trials& trials, const TuneTrial& choice) {
  TuneMargins margins;
  const double G = trials.question.margin, largest = trials.ranges.stiffness.to,
               most = std::min(largest, trials.refuted) / choice.stiffness;
  if (most > G * (1.0 + kTuneResolution))
    margins.gain =
        last_settled(trials, choice, {.range = {G, std::min(kMostGain, most), true}, .resolution = kTuneResolution},
                     [&](double gain) { return with_gain(choice, gain); });
  else if (trials.refuted < largest)
    margins.gain = G;
  const Scenario scenario = trials.load(choice, choice.stiffness, trials.family[0]).scenario;
  if (has_device(scenario)) {
    const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
    const SearchWay delays{.range = {0.0, kMostDelay}, .whole = whole, .resolution = 0.02 / kMostDelay};
    margins.delay_samples = last_settled(trials, choice, delays, [&](double more) {
      return fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more);
    });
  }
  const double lambda = trials.springs_lambda.value_or(choice.lambda_max);
  margins.damping_ratio = least_damping_ratio(scenario, lambda, trials.over_hands);
  return margins;
}

// ---- Nothing feasible

std::string then_text(const TuneTrial& trial) {
  return fmt::format("then K = {:.4g} N/m{}", trial.stiffness, setting_text(trial));
}

/// How far a limit has to give way to a trial: what the user asked for, or what is quiet.
std::string relaxed(const Trials& trials, const TuneTrial& trial, const std::string& name) {
  const auto worst = value_in(trial.worst, name);
  if (!worst) return fmt::format("drop the limit on {}, which has no value here", name);
  const double more = value_in(trials.error, name).value_or(0.0);
  const auto asked = trials.question.limits.find(name);
  const MetricBound& bound = asked == trials.question.limits.end() ? trials.limits.at(name) : asked->second;
  if (bound.max) return fmt::format("{} <= {:.3g} in place of {:.3g}", name, (*worst + more) * 1.001, *bound.max);
  return fmt::format("{} >= {:.3g} in place of {:.3g}", name, (*worst - more) * 0.999, bound.min.value_or(0.0));
}

/// For each limit the least by which it alone has to give way for a trial to keep all; else what the nearest needs.
std::string relaxations(const Trials& trials, const TuneTrial& nearest) {
  std::map<std::string, std::pair<double, const TuneTrial*>> least;
  for (const auto& [key, trial] : trials.all) {
    const TuneMetrics broken = trial.limits_alone ? trials.broken_limits(trial) : TuneMetrics();
    if (broken.size() != 1) continue;
    const auto& [name, times] = *broken.begin();
    const auto place = least.try_emplace(name, times, &trial).first;
    if (times < place->second.first) place->second = {times, &trial};
  }
  std::vector<std::string> texts;
  for (const auto& [name, trial] : least)
    texts.push_back(relaxed(trials, *trial.second, name) + "; " + then_text(*trial.second));
  if (!texts.empty()) return fmt::format("{}", fmt::join(texts, "; or "));
  for (const auto& [name, times] : trials.broken_limits(nearest)) texts.push_back(relaxed(trials, nearest, name));
  return fmt::format("{}; {}", fmt::join(texts, "; "), then_text(nearest));
}

/// Explains why nothing is feasible: what is in the way, and which limit to relax. If no limit is in the way, explains
/// a trial that lacks only the margin, or else the last trial.
void explain(Trials& trials, TunedLaw& law) {
  const TuneTrial* nearest = trials.nearest();
  const auto lacks_margin = [](const auto& tried) { return tried.second.binding == "margin"; };
  const auto found = std::ranges::find_if(trials.all, lacks_margin);
  const TuneTrial& other = found != trials.all.end() ? found->second : trials.all.rbegin()->second;
  const TuneTrial& trial = nearest != nullptr ? *nearest : other;
  law.binding = trial.binding;
  law.why = trial.why;
  if (nearest == nullptr) {
    law.relax = law.binding == "margin" ? "a smaller --margin; else" : "no limit is to blame:";
    law.relax += " a gentler hand, a wider tool or another device, or other runs with --family";
    return;
  }
  if (!trials.is_quiet) trials.error = known_errors(trials, trial);
  if (const auto error = value_in(trials.error, law.binding); error.value_or(0.0) > 0.0)
    law.why += fmt::format(" +- {:.2g}", *error);
  law.relax = relaxations(trials, trial);
  if (trials.is_quiet)
    law.relax += "; a limit of your own, such as --bound force_rms_above_30Hz_N=0.05, takes the place of what is quiet";
}

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  TunedLaw law;
  law.algorithm = algorithm;
  Trials trials(question, algorithm);
  TuneSearch search(trials);
  // Where a choice does not hold, no trial that reaches what failed is feasible any more.
  do {
    law.choice = search.best();
  } while (law.choice && (fails_between(trials, *law.choice, law) || own_edge_is_near(trials, *law.choice, law) ||
                          fails_later(trials, *law.choice) || is_beyond_limits(trials, *law.choice, law)));
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
