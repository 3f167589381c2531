#include "scenarios/limits/tuning/tune.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "scenarios/limits/convergence/convergence.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
std::optional<double> value_in(const TuneMetrics& metrics, std::string_view name, double factor) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(factor * found->second);
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
  ranges.stiffness = limit_question(question.scenario, overrides, kStiffnessPath, {}).range;
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

// ---- Trials

constexpr double kTuneResolution = 5e-3;  // of K

std::string with(const FamilyMember& member) {
  return member.overrides.empty() ? "" : fmt::format(" ({})", member.name);
}

std::string verdict_with(const RunStability& run, const FamilyMember& member) {
  return std::string(run_verdict_name(run.verdict)) + with(member);
}

/// Notes the worst value of a limited metric over the family; empty where it has none in some run.
void note_worst(TuneTrial& trial, const std::string& name, const MetricBound& bound,
                std::span<const TuneMetrics> metrics, std::span<const FamilyMember> family) {
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const auto value = value_in(metrics[i], name);
    if (!value) {
      trial.worst.erase(name);
      trial.worst_text[name] = name + " has no value" + with(family[i]);
      return;
    }
    const auto [worst, is_first] = trial.worst.try_emplace(name, *value);
    const bool is_worse = bound.max ? *value > worst->second : *value < worst->second;
    if (!is_first && !is_worse) continue;
    worst->second = *value;
    trial.worst_text[name] = fmt::format("{} {:.4g}{}", name, *value, with(family[i]));
  }
}

/// A run that is not settled.
struct Failing {
  std::size_t run;  ///< its number
  std::string why;
};

/// The trials of one law: settings at stiffnesses, each judged by the runs of the family when it is first asked for.
struct Trials {
  const TuneQuestion& question;
  const std::string& algorithm;
  TuneRanges ranges = tune_ranges(question, algorithm);
  /// The family has other hands.
  bool over_hands = std::ranges::find(question.families, "hands") != question.families.end();
  bool is_quiet = question.limits.empty();  ///< the limits are those of a quiet run
  /// What is allowed: the limits of the question less what is known of errors.
  std::map<std::string, MetricBound> limits = question.limits;
  std::vector<FamilyMember> family = {{"the scene's own run"}};
  std::shared_ptr<const PointShell> shell = {};
  std::optional<double> springs_lambda = {};                 ///< of springs, which their place does not change
  double refuted = std::numeric_limits<double>::infinity();  ///< least K known not to be settled at a choice [N/m]
  double cap = ranges.stiffness.to;                          ///< largest K that may be tried for all that [N/m]
  TuneTrial end = {};                                        ///< beyond `cap` or the range: only the reason counts
  TuneMetrics error = {};                                    ///< of the choice that was looked at last
  std::map<std::pair<TuneSetting, double>, TuneTrial> all = {};
  std::size_t runs = 0;

  /// `asked` and `law` have to outlive this.
  Trials(const TuneQuestion& asked, const std::string& law) : question(asked), algorithm(law) {
    const LoadedScenario own = load({}, ranges.stiffness.from, {});
    shell = make_shell(own.scenario, own.files);
    for (const std::string& of : question.families)
      for (FamilyMember& member : family_of(own, of)) family.push_back(std::move(member));
    if (springs_stay(own.scenario)) springs_lambda = stiffness_eigenvalues(own.scenario)[2];
    for (const DiagnosisRule& rule : diagnosis_rules())
      if (is_quiet && rule.quiet) limits[rule.name].max = rule.threshold;
    end.fail("range", "the end of the range that was searched");
  }

  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const {
    std::vector<std::string> words = question.overrides;
    words.push_back("rendering.algorithm=" + algorithm);
    if (setting.damping_ratio) {
      words.push_back("rendering.damping_N_s_per_m=null");
      words.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
    }
    if (setting.mass) words.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
    if (!setting.filter.empty()) words.push_back("device.velocity_filter=" + setting.filter);
    words.push_back(fmt::format("{}={}", kStiffnessPath, stiffness));
    return words;
  }

  LoadedScenario load(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                      const std::string& more = {}) const {
    std::vector<std::string> fields = overrides(setting, stiffness);
    fields.insert(fields.end(), member.overrides.begin(), member.overrides.end());
    if (!more.empty()) fields.push_back(more);
    return load_scenario(question.scenario, fields);
  }

  /// The first of so many runs of a trial, the family taking turns, that is not settled under a further override, such
  /// as a larger K, up to which the loop in contact has to be stable, too.
  std::optional<Failing> first_failing(const TuneTrial& trial, std::size_t count,
                                       const std::function<std::string(std::size_t run)>& more) {
    const double lambda = springs_lambda.value_or(trial.lambda_max), K = trial.stiffness;
    std::vector<std::string> why(count);
    in_parallel(count, [&](std::size_t i) {
      const FamilyMember& member = family[i % family.size()];
      const LoadedScenario loaded = load(trial, K, member, more(i));
      if (unstable_loop(loaded.scenario, lambda, K, loaded.scenario.rendering.stiffness)) {
        why[i] = "unstable in contact" + with(member);
        return;
      }
      const RunStability run = stability_of(loaded, shell, rule_of(loaded.scenario));
      if (!is_stable(run.verdict)) why[i] = verdict_with(run, member);
    });
    for (std::size_t i = 0; i < count; ++i)
      if (!why[i].empty()) return Failing{i, why[i]};
    return std::nullopt;
  }

  TuneTrial& tried(const TuneSetting& setting, double stiffness) {
    const auto [place, is_new] = all.try_emplace({setting, stiffness});
    TuneTrial& trial = place->second;
    if (!is_new) return trial;
    static_cast<TuneSetting&>(trial) = setting;
    trial.algorithm = algorithm;
    trial.stiffness = stiffness;
    if (springs_lambda && !judge_loop(trial, family[0], *springs_lambda, "the device alone")) return trial;
    if (runs >= kMostTuneRuns) {
      trial.fail("runs", fmt::format("the search ended after {} runs", runs));
      return trial;
    }
    judge_motion(trial, 0, 1);
    if (trial.feasible() && family.size() > 1) judge_motion(trial, 1, family.size());
    if (trial.feasible()) judge_limits(trial);
    return trial;
  }
  bool feasible(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap && tried(setting, stiffness).feasible();
  }
  /// The trial, or above `cap` the end.
  const TuneTrial& beyond(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap ? tried(setting, stiffness) : end;
  }

  /// Gives the trial the metrics of the scene's own run, unless it has them.
  void measure(TuneTrial& trial) {
    if (!trial.metrics.empty()) return;
    in_parallel(1, [&](std::size_t) {
      trial.metrics = metrics_of(run_with_shell(load(trial, trial.stiffness, family[0]), shell));
    });
  }

  /// The limits that a trial does not keep, and how many times its limit each worst value is: more than 1, infinite
  /// without a value, which only a run that is to be quiet may lack. Precondition: they were measured (judge_limits).
  TuneMetrics broken_limits(const TuneTrial& trial) const {
    constexpr double kBeyond = std::numeric_limits<double>::infinity();
    const auto times = [](double far, double near) {
      return far > 0.0 && near > 0.0 ? std::max(far / near, std::nextafter(1.0, 2.0)) : kBeyond;
    };
    TuneMetrics broken;
    for (const auto& [name, bound] : limits) {
      const auto value = value_in(trial.worst, name);
      if (!value && !is_quiet) broken[name] = kBeyond;
      if (value && bound.min && *value < *bound.min) broken[name] = times(*bound.min, *value);
      if (value && bound.max && *value > *bound.max) broken[name] = times(*value, *bound.max);
    }
    return broken;
  }
  /// Notes the first of them. Same precondition.
  void judge_worst(TuneTrial& trial) const {
    const TuneMetrics broken = broken_limits(trial);
    trial.binding.clear();
    trial.too_soft = false;
    trial.limits_alone = !broken.empty();
    if (broken.empty()) return;
    const std::string& name = broken.begin()->first;
    trial.too_soft =
        limits.at(name).max && trial.worst.contains(name) && (name.starts_with("inside") || name.starts_with("depth"));
    trial.fail(name, trial.worst_text.at(name));
  }
  /// How many limits a trial does not keep, and the largest number of times.
  std::pair<std::size_t, double> excess(const TuneTrial& trial) const {
    std::pair<std::size_t, double> found;
    for (const auto& [name, times] : broken_limits(trial)) found = {found.first + 1, std::max(found.second, times)};
    return found;
  }
  /// Of the trials that only limits are in the way of, the one with the least excess; null without one.
  const TuneTrial* nearest() const {
    const TuneTrial* nearest = nullptr;
    for (const auto& [key, trial] : all)
      if (trial.limits_alone && (nearest == nullptr || excess(trial) < excess(*nearest))) nearest = &trial;
    return nearest;
  }

 private:
  void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
    runs += count;
    for_each_job(count, {question.threads, ""}, job);
    if (question.on_runs) question.on_runs(runs);
  }

  TuneMetrics metrics_of(const Result& run) const {
    TuneMetrics metrics;
    const auto add = [&](const std::string& name) {
      if (const auto value = number_of(run.metrics, name)) metrics[name] = *value;
    };
    for (const char* name : kTuneMetrics) add(name);
    for (const auto& [name, bound] : question.limits) add(name);
    return metrics;
  }

  /// The hand with which the loop is unstable at some stiffness from K to `most`, if there is one.
  std::optional<std::string> unstable_loop(Scenario scenario, double lambda, double K, double most) const {
    constexpr double kStride = 1.1;
    for (double at = most; lambda > 0.0 && at * kStride > K; at /= kStride) {
      scenario.rendering.stiffness = at;
      for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands))
        if (!is_stable_step(step)) return hand;
    }
    return std::nullopt;
  }

  /// False where the loop in contact of a member is unstable up to the margin.
  bool judge_loop(TuneTrial& trial, const FamilyMember& member, double lambda, const std::string& own_hand) const {
    const double K = trial.stiffness;
    const auto hand = unstable_loop(load(trial, K, member).scenario, lambda, K, question.margin * K);
    if (!hand) return true;
    trial.fail("margin", fmt::format("below {:g} K the loop in contact is unstable with {}", question.margin,
                                     hand->empty() ? own_hand : *hand));
    return false;
  }

  /// Finds the first of the members from `first` on that is not settled with the margin.
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
    std::vector<RunStability> judged(2 * (last - first));  // of each member at K and at G K
    in_parallel(judged.size(), [&](std::size_t job) {
      const double gain = job % 2 != 0 ? question.margin : 1.0;
      const LoadedScenario loaded = load(trial, gain * trial.stiffness, family[first + job / 2]);
      judged[job] = stability_of(loaded, shell, rule_of(loaded.scenario));
    });
    if (first == 0) trial.lambda_max = judged[0].settled.lambda_max;
    for (std::size_t i = first; i < last; ++i) {
      const RunStability &at_K = judged[2 * (i - first)], &at_GK = judged[2 * (i - first) + 1];
      if (!is_stable(at_K.verdict)) {
        trial.too_soft = at_K.verdict >= RunVerdict::thrown_out && at_K.verdict <= RunVerdict::went_through;
        return trial.fail("settled", verdict_with(at_K, family[i]));
      }
      trial.settled = true;
      if (!is_stable(at_GK.verdict))
        return trial.fail("margin", fmt::format("at {:g} K {}", question.margin, verdict_with(at_GK, family[i])));
      // Of springs it was asked before the runs.
      if (!springs_lambda && !judge_loop(trial, family[i], at_K.settled.lambda_max, family[i].name)) return;
    }
  }

  /// Runs the family for the metrics that are limited, and finds the first limit that is not kept.
  void judge_limits(TuneTrial& trial) {
    // What is quiet is asked of the scene's own run, a user's metrics of all.
    std::vector<TuneMetrics> metrics(is_quiet ? 1 : family.size());
    in_parallel(metrics.size(), [&](std::size_t i) {
      const LoadedScenario loaded = load(trial, trial.stiffness, family[i]);
      const Result run = run_with_shell(loaded, shell);
      metrics[i] = metrics_of(run);
      if (!is_quiet) return;
      for (const Diagnosed& number : quiet_numbers(loaded, run)) {
        trial.worst[number.rule] = number.value;
        trial.worst_text[number.rule] = number.says;
      }
    });
    trial.metrics = metrics[0];
    for (const auto& [name, bound] : question.limits) note_worst(trial, name, bound, metrics, family);
    judge_worst(trial);
  }
};

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
  static_cast<StabilityRule&>(question) = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question.threads;
  law.edge = field_limit(question);
  trials.runs += law.edge.runs.size();
  const double G_K = trials.question.margin * choice.stiffness;
  if (!law.edge.value) return refute(trials, choice, G_K, "stable values are scattered");
  if (!law.edge.beyond) return false;
  const auto& [K, verdict] = *law.edge.beyond;
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

/// For each limit the least by which it alone has to give way for a trial to keep all; where one is not enough, what
/// the nearest trial needs.
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
