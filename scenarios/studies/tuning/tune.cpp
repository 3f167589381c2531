#include "scenarios/studies/tuning/tune.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/studies/convergence/convergence.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "sim/core/bisection.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr const char* kTunedField = "rendering.stiffness_N_per_m";
constexpr const char* kFilters[] = {R"({"type":"difference"})", R"({"type":"low_pass","cutoff_Hz":50})",
                                    R"({"type":"low_pass","cutoff_Hz":100})", R"({"type":"low_pass","cutoff_Hz":200})",
                                    R"({"type":"adaptive_window"})"};

}  // namespace

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

constexpr double kResolution = 5e-3;  // of K
constexpr double kFinest = 1.004;     // ratio of zeta, or of the mass, at which the search ends
constexpr double kMuchLess = 1.25;    // of K, that is given up where a choice does not hold for longer

/// Tunes one law of a question.
class Tuner {
 public:
  Tuner(const TuneQuestion& question, const std::string& algorithm)
      : question_(question), algorithm_(algorithm), ranges_(tune_ranges(question, algorithm)) {
    const LoadedScenario own = at({}, ranges_.stiffness.from, {});
    shell_ = make_shell(own.scenario, own.files);
    settings_ = settings_of(ranges_, own.scenario);
    family_.push_back({"the scene's own run"});
    for (const FamilyOver over : question.over)
      for (FamilyMember& member : family_of(own, over)) family_.push_back(std::move(member));
    fail(end_, "range", "the end of the range that was searched");
    if (springs_stay(own.scenario)) springs_lambda_ = stiffness_eigenvalues(own.scenario)[2];
    has_filters_ = question.filters && handle_moves_tool(own.scenario.device);
    limits_ = question.limits;
    is_quiet_ = limits_.empty();
    for (const DiagnosisRule& rule : diagnosis_rules())
      if (is_quiet_ && rule.quiet) limits_[rule.name].max = rule.threshold;
    cap_ = ranges_.stiffness.to;
  }

  TunedLaw tuned() {
    TunedLaw law;
    law.algorithm = algorithm_;
    do {
      best_.reset();
      search();
    } while (best_ && (is_refuted(*best_, law) || is_beyond_limits(*best_, law)));
    if (best_) {
      law.choice = best_;
      law.binding = beyond_.binding;
      law.why = beyond_.why;
      law.margins = margins(*best_);
      law.overrides = overrides(*best_, best_->stiffness);
      along_stiffness(*best_);
    } else {
      explain(law);
    }
    for (const auto& [key, trial] : trials_) law.trials.push_back(trial);
    law.runs = runs_;
    return law;
  }

 private:
  // ---- Runs

  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const {
    std::vector<std::string> all = question_.overrides;
    all.push_back("rendering.algorithm=" + algorithm_);
    if (setting.damping_ratio) {
      all.push_back("rendering.damping_N_s_per_m=null");
      all.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
    }
    if (setting.mass) all.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
    if (!setting.filter.empty()) all.push_back("device.velocity_filter=" + setting.filter);
    all.push_back(fmt::format("{}={}", kTunedField, stiffness));
    return all;
  }
  LoadedScenario at(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                    const std::string& more = {}) const {
    std::vector<std::string> all = overrides(setting, stiffness);
    all.insert(all.end(), member.overrides.begin(), member.overrides.end());
    if (!more.empty()) all.push_back(more);
    return load_scenario(question_.scenario, all);
  }

  void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
    runs_ += count;
    for_each_job(count, {question_.threads, ""}, job);
    if (question_.on_runs) question_.on_runs(runs_);
  }
  JudgedRun judged(const LoadedScenario& loaded) const { return judged_run(loaded, shell_, rule_of(loaded.scenario)); }
  /// The metrics of a choice and those that are limited.
  TuneMetrics metrics_of(const Result& run) const {
    TuneMetrics metrics;
    const auto add = [&](const std::string& name) {
      if (const auto value = number_of(run.metrics, name)) metrics[name] = *value;
    };
    for (const char* name : kTuneMetrics) add(name);
    for (const auto& [name, bound] : question_.limits) add(name);
    return metrics;
  }
  TuneMetrics own_metrics_of(const TuneTrial& trial) {
    TuneMetrics metrics;
    in_parallel(
        1, [&](std::size_t) { metrics = metrics_of(run_with_shell(at(trial, trial.stiffness, family_[0]), shell_)); });
    return metrics;
  }

  // ---- The loop in contact

  bool over_hands() const { return std::ranges::find(question_.over, FamilyOver::hands) != question_.over.end(); }

  /// The hand with which the loop is unstable somewhere from K to `gain` K; none where there is none.
  std::optional<std::string> unstable_loop(Scenario scenario, double lambda, double stiffness, double gain) const {
    if (!(lambda > 0.0)) return std::nullopt;
    constexpr double kStride = 1.1;
    for (double K = gain * stiffness; K * kStride > stiffness; K /= kStride) {
      scenario.rendering.stiffness = K;
      for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands()))
        if (!is_stable_step(step)) return hand;
    }
    return std::nullopt;
  }

  // ---- Trials

  static std::string with(const FamilyMember& member) {
    return member.overrides.empty() ? "" : fmt::format(" ({})", member.name);
  }

  /// Finds the first of the members from `first` on that is not settled with the margin.
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
    std::vector<JudgedRun> runs(2 * (last - first));  // of each member at K and at G K
    in_parallel(runs.size(), [&](std::size_t job) {
      const double gain = job % 2 != 0 ? question_.margin : 1.0;
      runs[job] = judged(at(trial, gain * trial.stiffness, family_[first + job / 2]));
    });
    if (first == 0) trial.lambda_max = runs[0].settled.lambda_max;
    for (std::size_t i = first; i < last; ++i) {
      const JudgedRun &at_K = runs[2 * (i - first)], &at_GK = runs[2 * (i - first) + 1];
      if (!is_stable(at_K.verdict)) {
        trial.too_soft = at_K.verdict >= RunVerdict::thrown_out && at_K.verdict <= RunVerdict::went_through;
        return fail(trial, "settled", std::string(run_verdict_name(at_K.verdict)) + with(family_[i]));
      }
      trial.settled = true;
      if (!is_stable(at_GK.verdict)) {
        return fail(trial, "margin",
                    fmt::format("at {:g} K {}{}", question_.margin, run_verdict_name(at_GK.verdict), with(family_[i])));
      }
      // Of springs it was asked before the runs.
      if (!springs_lambda_ && !judge_loop(trial, i, at_K.settled.lambda_max, family_[i].name)) return;
    }
  }

  /// False where the loop in contact of a member is unstable up to the margin.
  bool judge_loop(TuneTrial& trial, std::size_t member, double lambda, const std::string& own_hand) const {
    const Scenario scenario = at(trial, trial.stiffness, family_[member]).scenario;
    const auto hand = unstable_loop(scenario, lambda, trial.stiffness, question_.margin);
    if (!hand) return true;
    fail(trial, "margin",
         fmt::format("below {:g} K the loop in contact is unstable with {}", question_.margin,
                     hand->empty() ? own_hand : *hand));
    return false;
  }

  /// Finds the worst of what is limited: of a quiet run in the scene's own, of a user's metrics in all.
  void judge_limits(TuneTrial& trial) {
    const std::size_t members = is_quiet_ ? 1 : family_.size();
    std::vector<TuneMetrics> metrics(members);
    in_parallel(members, [&](std::size_t i) {
      const LoadedScenario loaded = at(trial, trial.stiffness, family_[i]);
      const Result run = run_with_shell(loaded, shell_);
      metrics[i] = metrics_of(run);
      if (!is_quiet_) return;
      for (const Diagnosed& number : quiet_numbers(loaded, run)) {
        trial.worst[number.rule] = number.value;
        trial.worst_text[number.rule] = number.says;
      }
    });
    trial.metrics = metrics[0];
    for (const auto& [name, bound] : question_.limits) note_worst(trial, name, bound, metrics);
    judge_worst(trial);
  }

  /// The worst value of a limited metric; none where it has none in some run.
  void note_worst(TuneTrial& trial, const std::string& name, const MetricBound& bound,
                  std::span<const TuneMetrics> metrics) const {
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      const auto found = metrics[i].find(name);
      if (found == metrics[i].end()) {
        trial.worst.erase(name);
        trial.worst_text[name] = name + " has no value" + with(family_[i]);
        return;
      }
      const auto [worst, is_first] = trial.worst.try_emplace(name, found->second);
      const bool is_worse = bound.max ? found->second > worst->second : found->second < worst->second;
      if (!is_first && !is_worse) continue;
      worst->second = found->second;
      trial.worst_text[name] = fmt::format("{} {:.4g}{}", name, found->second, with(family_[i]));
    }
  }

  /// Finds the first limit that is not kept. Precondition: judge_limits.
  void judge_worst(TuneTrial& trial) const {
    trial.binding.clear();
    trial.too_soft = false;
    for (const auto& [name, bound] : limits_) {
      if (!(times_limit(trial, name, bound) > 1.0)) continue;
      trial.too_soft =
          bound.max && trial.worst.contains(name) && (name.starts_with("inside") || name.starts_with("depth"));
      fail(trial, name, trial.worst_text.at(name));
      break;
    }
    trial.limits_alone = !trial.feasible();
  }

  /// How many times its limit the worst value is; at most 1 where it is kept, infinite where there is no value. A quiet
  /// run has no number of what it has nothing of.
  double times_limit(const TuneTrial& trial, const std::string& name, const MetricBound& bound) const {
    constexpr double kBeyond = std::numeric_limits<double>::infinity();
    const auto found = trial.worst.find(name);
    if (found == trial.worst.end()) return is_quiet_ ? 0.0 : kBeyond;
    const double value = found->second;
    const auto times = [](double far, double near) { return far > 0.0 && near > 0.0 ? far / near : kBeyond; };
    if (bound.max && value > *bound.max) return std::max(times(value, *bound.max), std::nextafter(1.0, 2.0));
    if (bound.min && value < *bound.min) return std::max(times(*bound.min, value), std::nextafter(1.0, 2.0));
    return 1.0;
  }

  static void fail(TuneTrial& trial, const std::string& binding, const std::string& why) {
    trial.binding = binding;
    trial.why = why;
  }
  TuneTrial& tried(const TuneSetting& setting, double stiffness) {
    const auto [place, is_new] = trials_.try_emplace({setting, stiffness});
    TuneTrial& trial = place->second;
    if (!is_new) return trial;
    static_cast<TuneSetting&>(trial) = setting;
    trial.algorithm = algorithm_;
    trial.stiffness = stiffness;
    if (springs_lambda_ && !judge_loop(trial, 0, *springs_lambda_, "the device alone")) return trial;
    if (runs_ >= kMostTuneRuns) {
      fail(trial, "runs", fmt::format("the search ended after {} runs", runs_));
      return trial;
    }
    judge_motion(trial, 0, 1);
    if (trial.feasible() && family_.size() > 1) judge_motion(trial, 1, family_.size());
    if (trial.feasible()) judge_limits(trial);
    return trial;
  }
  bool feasible(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap_ && tried(setting, stiffness).feasible();
  }
  const TuneTrial& beyond(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap_ ? tried(setting, stiffness) : end_;
  }

  // ---- Search

  Range stiffnesses() const { return {ranges_.stiffness.from, ranges_.stiffness.to / question_.margin, true}; }

  void search() {
    for (const TuneSetting& setting : settings_) improve(setting);
    if (!best_) approach();
    if (!best_) return;
    for (const char* filter : kFilters) {
      for (const TuneSetting& setting : settings_)
        if (has_filters_ && setting.mass == best_->mass) improve({setting.damping_ratio, setting.mass, filter});
    }
    refine();
  }

  void refine() {
    for (double ratio = math::pow(10.0, 0.125); ratio > kFinest; ratio = std::sqrt(ratio)) {
      for (bool better = true; better;) {
        better = false;
        for (const double step : {ratio, 1.0 / ratio}) {
          for (const auto& [value, range] : searched()) {
            if (!range) continue;
            TuneSetting next = *best_;
            next.*value = std::clamp(*(next.*value) * step, range->from, range->to);
            better = improve(next) || better;
          }
        }
      }
    }
  }

  /// Raises K at this setting if it can be raised beyond the best; true if it was.
  bool improve(const TuneSetting& setting) {
    SearchWay way{.range = stiffnesses(), .resolution = kResolution};
    if (best_) {
      way.range.from = best_->stiffness * (1.0 + kResolution);
      if (!(way.range.from < way.range.to)) return false;
      if (!feasible(setting, way.range.from)) {
        if (setting == *best_) beyond_ = beyond(setting, way.range.from);
        return false;
      }
    }
    const auto holds = [&](double part) { return feasible(setting, way.value_at(part)); };
    std::map<double, bool> scan = scanned(kEdgeIntervals, holds);
    if (const auto between = window(setting, way, scan)) scan[*between] = true;
    const FoundEdge edge = find_edge(way, scan, holds, kResolution, false);
    if (!edge.stable) return false;
    best_ = tried(setting, way.value_at(*edge.stable));
    beyond_ = edge.beyond ? beyond(setting, way.value_at(*edge.beyond)) : end_;
    return true;
  }

  /// Where only limits are not kept, walks from the trial that is nearest to keeping them all towards them.
  void approach() {
    const TuneTrial* at = nearest();
    if (at == nullptr) return;
    const auto is_better = [&](const TuneSetting& setting, double stiffness) {
      const Range range = stiffnesses();
      TuneTrial& next = tried(setting, std::clamp(stiffness, range.from, std::min(cap_, range.to)));
      if (next.feasible()) best_ = next;
      if (!best_ && !(next.limits_alone && excess(next) < excess(*at))) return false;
      at = &next;
      return true;
    };
    for (double ratio = math::pow(10.0, 0.25); ratio > kFinest && !best_; ratio = std::sqrt(ratio))
      while (!best_ && std::ranges::any_of(neighbours(*at, ratio),
                                           [&](const TuneTrial& n) { return is_better(n, n.stiffness); })) {
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
    for (const char* filter : kFilters) {
      if (!has_filters_) break;
      all.push_back(trial);
      all.back().filter = filter;
    }
    return all;
  }

  using Searched = std::pair<std::optional<double> TuneSetting::*, std::optional<Range>>;
  std::array<Searched, 2> searched() const {
    return {{{&TuneSetting::damping_ratio, ranges_.damping_ratio}, {&TuneSetting::mass, ranges_.mass}}};
  }

  /// Where no value of a scan is feasible: one between those that are too soft and those that are too stiff.
  std::optional<double> window(const TuneSetting& setting, const SearchWay& way, const std::map<double, bool>& scan) {
    const auto soft = [&](double part) { return tried(setting, way.value_at(part)).too_soft; };
    for (auto at = scan.begin(); std::next(at) != scan.end(); ++at) {
      if (at->second || !soft(at->first) || std::next(at)->second || soft(std::next(at)->first)) continue;
      double low = at->first, high = std::next(at)->first;
      while (way.apart(low, high, kResolution)) {
        const double middle = 0.5 * (low + high);
        if (feasible(setting, way.value_at(middle))) return middle;
        (soft(middle) ? low : high) = middle;
      }
    }
    return std::nullopt;
  }

  // ---- What is known of a choice

  /// What a choice is strained by: a factor on K and a further override.
  struct Strain {
    double gain = 1.0;
    std::string more = {};
  };
  using Strained = std::function<Strain(double value)>;  ///< at a value of a way

  /// Why the run of a member is not settled; empty where it is.
  std::string unsettled(const TuneTrial& trial, const FamilyMember& member, const Strain& strain) const {
    const LoadedScenario loaded = at(trial, strain.gain * trial.stiffness, member, strain.more);
    const double lambda = springs_lambda_.value_or(trial.lambda_max);
    if (unstable_loop(loaded.scenario, lambda, trial.stiffness, strain.gain))
      return "unstable in contact" + with(member);
    const RunVerdict verdict = judged(loaded).verdict;
    return is_stable(verdict) ? "" : std::string(run_verdict_name(verdict)) + with(member);
  }
  /// Why a run of the family is not settled; empty where all are.
  std::string unsettled(const TuneTrial& trial, const Strain& strain) {
    std::vector<std::string> why(family_.size());
    in_parallel(family_.size(), [&](std::size_t i) { why[i] = unsettled(trial, family_[i], strain); });
    const auto first = std::ranges::find_if(why, [](const std::string& one) { return !one.empty(); });
    return first == why.end() ? "" : *first;
  }
  bool is_settled(const TuneTrial& trial, const Strain& strain) { return unsettled(trial, strain).empty(); }

  /// A part of a way at which a run is not settled, and why.
  struct Failing {
    double part;
    std::string why;
  };
  /// The first of these parts, the family taking turns.
  std::optional<Failing> first_failing(const TuneTrial& trial, const SearchWay& way, std::span<const double> parts,
                                       const Strained& strained) {
    std::vector<std::string> why(parts.size());
    in_parallel(parts.size(), [&](std::size_t i) {
      why[i] = unsettled(trial, family_[i % family_.size()], strained(way.value_at(parts[i])));
    });
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (!why[i].empty()) return Failing{parts[i], why[i]};
    return std::nullopt;
  }
  static Strain by_gain(double gain) { return {gain}; }

  /// True where the choice does not hold at gains between 1 and G, or in runs twice as long. Then no K is tried any
  /// more that reaches what failed.
  bool is_refuted(const TuneTrial& trial, TunedLaw& law) {
    const SearchWay gains{.range = {1.0, question_.margin, true}};
    std::vector<double> parts = parts_between(0.0, 1.0, kTriedBetween);
    const std::vector<double> near = parts_between(1.0, 1.0 - near_part(gains, 1.0), kTriedNear);
    parts.insert(parts.end(), near.begin(), near.end());
    if (const auto failing = first_failing(trial, gains, parts, by_gain)) {
      const double K = trial.stiffness * gains.value_at(failing->part);
      refuted_ = std::min(refuted_, K);
      cap_ = K / question_.margin * (1.0 - kResolution);
      fail(end_, "margin", fmt::format("at {:.4g} N/m{} {}", K, setting_text(trial), failing->why));
      return true;
    }
    law.verified = parts.size();
    if (own_edge_is_near(trial, law)) return true;
    const Scenario own = at(trial, trial.stiffness, family_[0]).scenario;
    const double duration = own.time.step * static_cast<double>(own.time.steps);
    // A script that leads on comes to places that the scene does not ask for.
    if (script_moves_until(own) > duration && script_period(own) == 0.0) return false;
    const std::string why = unsettled(trial, {1.0, fmt::format("time.steps={}", 2 * own.time.steps)});
    if (why.empty()) return false;
    cap_ = trial.stiffness / kMuchLess;
    fail(end_, "settled",
         fmt::format("at {:.4g} N/m{} in a run twice as long {}", trial.stiffness, setting_text(trial), why));
    return true;
  }

  /// Finds the edges of K in the scene as chosen; true where the own run has one before G K.
  bool own_edge_is_near(const TuneTrial& trial, TunedLaw& law) {
    const std::vector<std::string> chosen = overrides(trial, trial.stiffness);
    law.edge_question = limit_question(question_.scenario, chosen, kTunedField, {});
    static_cast<StabilityRule&>(law.edge_question) = rule_of(load_scenario(question_.scenario, chosen).scenario);
    law.edge_question.threads = question_.threads;
    law.edge = field_limit({&question_.scenario, chosen, algorithm_, law.edge_question});
    runs_ += law.edge.runs.size();
    const double G_K = question_.margin * trial.stiffness;
    if (!law.edge.value || (law.edge.beyond && law.edge.beyond->value < G_K)) {
      const double K = law.edge.value ? law.edge.beyond->value : G_K;
      refuted_ = std::min(refuted_, K);
      cap_ = K / question_.margin * (1.0 - kResolution);
      fail(end_, "margin",
           fmt::format("at {:.4g} N/m{} {}", K, setting_text(trial),
                       law.edge.value ? std::string(run_verdict_name(law.edge.beyond->verdict))
                                      : "stable values are scattered"));
      return true;
    }
    if (law.edge.beyond) refuted_ = std::min(refuted_, law.edge.beyond->value);
    return false;
  }

  /// True where a limit of the user is not kept by as much as the metric's error. Then less is allowed.
  bool is_beyond_limits(TuneTrial& choice, TunedLaw& law) {
    if (choice.metrics.empty()) choice.metrics = own_metrics_of(choice);
    law.error = last_error_ = known_errors(choice);
    bool beyond = false;
    for (const auto& [name, bound] : question_.limits) {
      const auto worst = choice.worst.find(name), error = law.error.find(name);
      if (worst == choice.worst.end() || error == law.error.end()) continue;
      MetricBound& allowed = limits_[name];
      if (bound.max && worst->second + error->second > *bound.max) {
        allowed.max = std::min(*allowed.max * (1.0 - kResolution), std::max(*bound.max - error->second, 0.0));
        beyond = true;
      }
      if (bound.min && worst->second - error->second < *bound.min) {
        allowed.min = *bound.min + error->second;
        beyond = true;
      }
    }
    for (auto& [key, trial] : trials_)
      if (beyond && (trial.limits_alone || trial.feasible())) judge_worst(trial);
    return beyond;
  }

  /// How far the metrics of the choice move where the scene's own run has half the step or half the distance of the
  /// points, and where its depth is looked at in every row: the largest difference; none of a metric that such a run
  /// does not have.
  TuneMetrics known_errors(const TuneTrial& choice) {
    std::vector<std::string> chosen = overrides(choice, choice.stiffness);
    const LoadedScenario own = load_scenario(question_.scenario, chosen);
    std::vector<Cases> finer;
    const auto add = [&](Axis axis) {
      finer.emplace_back(std::vector{question_.scenario}, chosen, std::vector{std::move(axis)});
    };
    add(finest_of(level_sweep(own, kStepPath, 2, 2.0).axis));
    if (const auto distance = point_distance(own)) {
      add(finest_of(level_sweep(own, distance->path, 2, 2.0).axis));
      add({.path = "record.inside", .values = {"true"}});
    }
    runs_ += finer.size();
    TuneMetrics error;
    std::vector<TuneMetrics> all;
    for (const Result& run : run_all(finer, {question_.threads, ""})) all.push_back(metrics_of(run));
    for (const auto& [name, value] : choice.metrics) {
      double most = 0.0;
      for (const TuneMetrics& metrics : all) {
        const auto found = metrics.find(name);
        most = found == metrics.end() ? std::numeric_limits<double>::infinity()
                                      : std::max(most, std::abs(found->second - value));
      }
      if (std::isfinite(most)) error[name] = most;
    }
    return error;
  }
  static Axis finest_of(Axis axis) {
    axis.values = {axis.values.back()};
    if (!axis.along.empty()) axis.along = {axis.along.back()};
    return axis;
  }

  /// The last value of a way up to which the choice is settled, also at values between.
  double last_settled(const TuneTrial& choice, const SearchWay& way, const Strained& strained) {
    const auto holds = [&](double part) { return is_settled(choice, strained(way.value_at(part))); };
    bool all = true;  // a run beyond the first edge tells nothing
    std::map<double, bool> scan = scanned(kEdgeIntervals, [&](double part) { return all = all && holds(part); });
    double last = find_edge(way, scan, holds, way.resolution, false).stable.value_or(0.0);
    while (const auto failing = first_failing(choice, way, parts_up_to(way, last), strained)) {
      const auto good = std::ranges::find_if(
          scan.rbegin(), scan.rend(), [&](const auto& tried) { return tried.second && tried.first < failing->part; });
      double low = good == scan.rend() ? 0.0 : good->first, high = failing->part;
      bisect(
          low, high, holds, [](double a, double b) { return 0.5 * (a + b); },
          [&](double a, double b) { return way.apart(a, b, way.resolution); });
      last = low;
    }
    return way.value_at(last);
  }
  /// kTriedBetween parts before the last, of delays also each quarter of a sample; of whole numbers all.
  static std::vector<double> parts_up_to(const SearchWay& way, double last) {
    std::vector<double> parts;
    if (!way.whole) parts = parts_between(0.0, last, kTriedBetween);
    const double step = way.range.logarithmic ? 1.0 : (way.whole ? 1.0 : 0.25) / (way.range.to - way.range.from);
    for (double part = step; part < last; part += step) parts.push_back(part);
    return parts;
  }

  TuneMargins margins(const TuneTrial& choice) {
    TuneMargins margins;
    const double most = std::min(ranges_.stiffness.to, refuted_) / choice.stiffness;
    if (most > question_.margin * (1.0 + kResolution)) {
      const SearchWay gains{.range = {question_.margin, std::min(kMostGain, most), true}, .resolution = kResolution};
      margins.gain = last_settled(choice, gains, by_gain);
    } else if (refuted_ < ranges_.stiffness.to) {
      margins.gain = question_.margin;
    }
    const Scenario scenario = at(choice, choice.stiffness, family_[0]).scenario;
    if (has_device(scenario)) {
      const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
      const SearchWay delays{.range = {0.0, kMostDelay}, .whole = whole, .resolution = 0.02 / kMostDelay};
      margins.delay_samples = last_settled(choice, delays, [&](double more) {
        return Strain{1.0, fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more)};
      });
    }
    const double lambda = springs_lambda_.value_or(choice.lambda_max);
    if (!(lambda > 0.0)) return margins;
    for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands())) {
      for (const std::complex<double>& z : eigenvalues(step)) {
        const double size = math::hypot(z.real(), z.imag());
        if (size < 1e-9) continue;  // a delay line
        const double decay = -math::log(size), ratio = decay / math::hypot(decay, math::atan2(z.imag(), z.real()));
        if (decay != 0.0) margins.damping_ratio = std::min(margins.damping_ratio.value_or(1.0), ratio);
      }
    }
    return margins;
  }

  /// Trials from a thirtieth of the choice's stiffness to thirty times, for pictures.
  void along_stiffness(const TuneTrial& choice) {
    const TuneSetting setting = choice;
    const Range around{choice.stiffness / 30.0, choice.stiffness * 30.0, true};
    for (int i = 0; i <= kEdgeIntervals; ++i) {
      const double K = around.value_at(static_cast<double>(i) / kEdgeIntervals);
      if (!(K > ranges_.stiffness.from && K < ranges_.stiffness.to / question_.margin)) continue;
      TuneTrial& trial = tried(setting, K);
      if (trial.settled && trial.metrics.empty()) trial.metrics = own_metrics_of(trial);
    }
  }

  // ---- Nothing feasible

  /// How far a trial is beyond its limits: how many it does not keep, and the largest ratio of a value to what is
  /// allowed.
  std::pair<int, double> excess(const TuneTrial& trial) const {
    std::pair<int, double> found{0, 0.0};
    for (const auto& [name, bound] : limits_) {
      const double times = times_limit(trial, name, bound);
      found.first += times > 1.0;
      found.second = std::max(found.second, times);
    }
    return found;
  }
  const TuneTrial* nearest() const {
    const TuneTrial* nearest = nullptr;
    for (const auto& [key, trial] : trials_)
      if (trial.limits_alone && (nearest == nullptr || excess(trial) < excess(*nearest))) nearest = &trial;
    return nearest;
  }

  /// By how much a limit has to give way to a trial.
  std::string relaxed(const TuneTrial& trial, const std::string& name, const MetricBound& bound) const {
    const auto worst = trial.worst.find(name);
    if (worst == trial.worst.end()) return fmt::format("drop the limit on {}, which has no value here", name);
    const auto error = last_error_.find(name);
    const double more = error == last_error_.end() ? 0.0 : error->second;
    if (bound.max)
      return fmt::format("{} <= {:.3g} in place of {:.3g}", name, (worst->second + more) * 1.001, *bound.max);
    return fmt::format("{} >= {:.3g} in place of {:.3g}", name, (worst->second - more) * 0.999,
                       bound.min.value_or(0.0));
  }
  static std::string then_text(const TuneTrial& trial) {
    return fmt::format("then K = {:.4g} N/m{}", trial.stiffness, setting_text(trial));
  }

  /// For each limit the least by which it alone has to give way for a trial to keep all; where one is not enough, what
  /// the nearest trial needs.
  std::string relaxations(const TuneTrial& nearest) const {
    std::vector<std::string> texts;
    for (const auto& [name, bound] : limits_) {
      const TuneTrial* least = nullptr;
      for (const auto& [key, trial] : trials_) {
        if (!trial.limits_alone || excess(trial).first != 1) continue;
        const double times = times_limit(trial, name, bound);
        if (times > 1.0 && (least == nullptr || times < times_limit(*least, name, bound))) least = &trial;
      }
      if (least != nullptr) texts.push_back(relaxed(*least, name, of_user(name, bound)) + "; " + then_text(*least));
    }
    if (!texts.empty()) return fmt::format("{}", fmt::join(texts, "; or "));
    for (const auto& [name, bound] : limits_)
      if (times_limit(nearest, name, bound) > 1.0) texts.push_back(relaxed(nearest, name, of_user(name, bound)));
    return fmt::format("{}; {}", fmt::join(texts, "; "), then_text(nearest));
  }
  const MetricBound& of_user(const std::string& name, const MetricBound& bound) const {
    const auto asked = question_.limits.find(name);
    return asked == question_.limits.end() ? bound : asked->second;
  }

  void explain(TunedLaw& law) {
    if (const TuneTrial* best = nearest()) {
      if (!is_quiet_) last_error_ = known_errors(*best);
      law.binding = best->binding;
      law.why = best->why;
      if (const auto error = last_error_.find(best->binding); error != last_error_.end() && error->second > 0.0)
        law.why += fmt::format(" +- {:.2g}", error->second);
      law.relax = relaxations(*best);
      if (is_quiet_)
        law.relax +=
            "; a limit of your own, such as --bound force_rms_above_30Hz_N=0.05, takes the place of what is quiet";
      return;
    }
    law.binding = "margin";
    // Settled at K, but not with the margin: the largest one that some trial has.
    std::vector<TuneTrial> settled_ones;
    for (const auto& [key, trial] : trials_)
      if (trial.binding == "margin" && trial.settled) settled_ones.push_back(trial);
    constexpr std::size_t kMostAsked = 8;
    double largest = 0.0;
    for (std::size_t i = 0; i < std::min(kMostAsked, settled_ones.size()); ++i) {
      const TuneTrial& trial = settled_ones[i * settled_ones.size() / std::min(kMostAsked, settled_ones.size())];
      const SearchWay gains{.range = {1.0, question_.margin, true}, .resolution = 0.02};
      if (!is_settled(trial, Strain{})) continue;
      const double gain = last_settled(trial, gains, by_gain);
      TuneTrial with_less = trial;
      with_less.binding.clear();
      if (gain > largest) judge_limits(with_less);
      if (gain <= largest || !with_less.feasible()) continue;
      largest = gain;
      law.why = trial.why;
      law.relax = fmt::format("margin {:.3g} in place of {:g}; then K = {:.4g} N/m{}", std::floor(gain * 100.0) / 100.0,
                              question_.margin, trial.stiffness, setting_text(trial));
    }
    if (largest > 0.0) return;
    law.binding = "settled";
    // Where too soft and too stiff meet, at a setting where only the margin is missing if there is one.
    const TuneTrial *soft = nullptr, *stiff = nullptr, *before = nullptr;
    for (const auto& [key, trial] : trials_) {
      const bool meets =
          before != nullptr && static_cast<const TuneSetting&>(*before) == trial && before->too_soft && !trial.too_soft;
      if (meets && (stiff == nullptr || (!stiff->settled && trial.settled))) {
        soft = before;
        stiff = &trial;
      }
      before = &trial;
    }
    law.why = before != nullptr ? before->why : "nothing was tried";
    if (soft != nullptr)
      law.why = fmt::format("up to {:.4g} N/m too soft, {}; from there on too stiff, {}", soft->stiffness, soft->why,
                            stiff->why);
    law.relax = "no limit is to blame: a gentler hand, a wider tool or another device, or other runs with --over";
  }
  const TuneQuestion& question_;
  const std::string& algorithm_;
  TuneRanges ranges_;
  std::vector<TuneSetting> settings_;
  bool has_filters_ = false;                   ///< velocity filters are searched, too
  bool is_quiet_ = false;                      ///< the limits are those of a quiet run
  std::map<std::string, MetricBound> limits_;  ///< what is allowed: those of the question less what is known of errors
  /// The least K that is known not to be settled within the margin of a choice, and the largest K that may be tried for
  /// all that [N/m].
  double refuted_ = std::numeric_limits<double>::infinity(), cap_ = 0.0;
  std::shared_ptr<const PointShell> shell_;
  std::vector<FamilyMember> family_;      ///< the scene's own first
  std::optional<double> springs_lambda_;  ///< of springs, which their place does not change
  std::map<std::pair<TuneSetting, double>, TuneTrial> trials_;
  std::size_t runs_ = 0;
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;        ///< just beyond the best
  TuneMetrics last_error_;  ///< of the choice that was looked at last
  TuneTrial end_;           ///< beyond the range, of which only the reason counts
};

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  return Tuner(question, algorithm).tuned();
}

}  // namespace hapbench
