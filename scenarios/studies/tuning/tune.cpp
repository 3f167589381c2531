#include "scenarios/studies/tuning/tune.hpp"

#include <fmt/format.h>

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
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
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
  if (question.filters && handle_moves_tool(own.device))
    filters.insert(filters.end(), std::begin(kFilters), std::end(kFilters));
  std::vector<TuneSetting> settings;
  for (const std::string& filter : filters)
    for (const auto& mass : masses)
      for (const auto& ratio : ratios) settings.push_back({ratio, mass, filter});
  return settings;
}

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
    for (const double m : {light.mass, heavy.mass})
      if (has_mass)
        hands.push_back({fmt::format("a hand of {} kg and {} N/m", m, k), {spring, fmt::format("hand.mass_kg={}", m)}});
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

namespace {

constexpr double kResolution = 5e-3;  // of K
constexpr double kFinest = 1.004;     // ratio of zeta, or of the mass, at which the search ends

/// Tunes one law of a question.
class Tuner {
 public:
  Tuner(const TuneQuestion& question, const std::string& algorithm)
      : question_(question), algorithm_(algorithm), ranges_(tune_ranges(question, algorithm)) {
    const LoadedScenario own = at({}, ranges_.stiffness.from, {});
    shell_ = make_shell(own.scenario, own.files);
    settings_ = settings_of(question, ranges_, own.scenario);
    family_.push_back({"the scene's own run"});
    for (const FamilyOver over : question.over)
      for (FamilyMember& member : family_of(own, over)) family_.push_back(std::move(member));
    fail(end_, "range", "the end of the range that was searched");
    if (springs_stay(own.scenario)) springs_lambda_ = stiffness_eigenvalues(own.scenario)[2];
  }

  TunedLaw tuned() {
    TunedLaw law;
    law.algorithm = algorithm_;
    Range range = ranges_.stiffness;
    range.to /= question_.margin;
    do {
      search(range);
      const auto failing = best_ ? failing_gain(*best_, law.verified) : std::nullopt;
      if (!failing) break;
      // Not settled at a gain within the margin: any K whose margin reaches there is out.
      range.to = best_->stiffness * *failing / question_.margin * (1.0 - kResolution);
      fail(end_, "margin", fmt::format("at {:.4g} N/m it is not settled", best_->stiffness * *failing));
      best_.reset();
    } while (range.to > range.from);
    if (best_) {
      if (best_->metrics.empty()) best_->metrics = own_metrics_of(*best_);
      law.choice = best_;
      law.binding = beyond_.binding;
      law.why = beyond_.why;
      law.margins = margins(*best_);
      law.spread = spread(*best_);
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
  }
  /// Where a script moves the tool, it is never at rest: then what is felt decides, as in `limit --stable still`.
  JudgedRun judged(const LoadedScenario& loaded) const {
    StabilityRule rule;
    if (is_moved(loaded.scenario)) rule.most_vibration = kMostVibration;
    return judged_run(loaded, shell_, rule);
  }
  TuneMetrics metrics_of(const LoadedScenario& loaded) const {
    const Result summary = run_with_shell(loaded, shell_);
    TuneMetrics metrics;
    const auto add = [&](const std::string& name) {
      if (const auto value = number_of(summary.metrics, name)) metrics[name] = *value;
    };
    for (const char* name : kTuneMetrics) add(name);
    for (const auto& [name, bound] : question_.limits) add(name);
    return metrics;
  }
  std::vector<TuneMetrics> metrics_of(const TuneTrial& trial, std::span<const FamilyMember> members) {
    std::vector<TuneMetrics> metrics(members.size());
    in_parallel(members.size(),
                [&](std::size_t i) { metrics[i] = metrics_of(at(trial, trial.stiffness, members[i])); });
    return metrics;
  }
  TuneMetrics own_metrics_of(const TuneTrial& trial) { return metrics_of(trial, std::span(family_).first(1))[0]; }

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

  /// Finds the first limit that a member does not keep, and the worst of each metric.
  void judge_limits(TuneTrial& trial) {
    if (question_.limits.empty()) return;
    const std::vector<TuneMetrics> metrics = metrics_of(trial, family_);
    trial.metrics = metrics[0];
    for (const auto& [name, bound] : question_.limits) {
      for (std::size_t i = 0; i < metrics.size(); ++i) {
        const auto found = metrics[i].find(name);
        const bool known = found != metrics[i].end();
        const double value = known ? found->second : 0.0;
        if (known) {
          double& worst = trial.worst.try_emplace(name, value).first->second;
          worst = bound.max ? std::max(worst, value) : std::min(worst, value);
        }
        const bool more = known && bound.max && value > *bound.max, less = known && bound.min && value < *bound.min;
        if ((known && !more && !less) || !trial.feasible()) continue;
        trial.too_soft = more && (name.starts_with("inside") || name.starts_with("depth"));
        fail(trial, name, (known ? fmt::format("{} {:.4g}", name, value) : name + " has no value") + with(family_[i]));
      }
    }
    trial.limits_alone = !trial.feasible();
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
  bool feasible(const TuneSetting& setting, double stiffness) { return tried(setting, stiffness).feasible(); }

  // ---- Search

  void search(const Range& range) {
    for (const TuneSetting& setting : settings_) improve(setting, range);
    if (!best_) return;
    using Searched = std::pair<std::optional<double> TuneSetting::*, std::optional<Range>>;
    const Searched all[] = {{&TuneSetting::damping_ratio, ranges_.damping_ratio}, {&TuneSetting::mass, ranges_.mass}};
    for (double ratio = math::pow(10.0, 0.125); ratio > kFinest; ratio = std::sqrt(ratio)) {
      for (bool better = true; better;) {
        better = false;
        for (const double step : {ratio, 1.0 / ratio}) {
          for (const auto& [value, searched] : all) {
            if (!searched) continue;
            TuneSetting next = *best_;
            next.*value = std::clamp(*(next.*value) * step, searched->from, searched->to);
            better = improve(next, range) || better;
          }
        }
      }
    }
  }

  /// Raises K at this setting if it can be raised beyond the best; true if it was.
  bool improve(const TuneSetting& setting, const Range& range) {
    SearchWay way{.range = range, .resolution = kResolution};
    way.range.logarithmic = true;
    if (best_) {
      way.range.from = best_->stiffness * (1.0 + kResolution);
      if (!(way.range.from < range.to)) return false;
      if (!feasible(setting, way.range.from)) {
        if (setting == *best_) beyond_ = tried(setting, way.range.from);
        return false;
      }
    }
    const auto holds = [&](double part) { return feasible(setting, way.value_at(part)); };
    std::map<double, bool> scan = scanned(kEdgeIntervals, holds);
    if (const auto between = window(setting, way, scan)) scan[*between] = true;
    const FoundEdge edge = find_edge(way, std::move(scan), holds, kResolution, false);
    if (!edge.stable) return false;
    best_ = tried(setting, way.value_at(*edge.stable));
    beyond_ = edge.beyond ? tried(setting, way.value_at(*edge.beyond)) : end_;
    return true;
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

  /// True when the runs of the whole family, with this gain and further override, are settled.
  bool settled(const TuneTrial& trial, double gain, const std::string& more = {}) {
    std::vector<char> stable(family_.size());
    in_parallel(family_.size(), [&](std::size_t i) {
      const LoadedScenario loaded = at(trial, gain * trial.stiffness, family_[i], more);
      const double lambda = springs_lambda_.value_or(trial.lambda_max);
      stable[i] = !unstable_loop(loaded.scenario, lambda, trial.stiffness, gain) && is_stable(judged(loaded).verdict);
    });
    return std::ranges::all_of(stable, [](char one) { return one != 0; });
  }

  /// The first of the gains from 1 to G at which the choice is not settled.
  std::optional<double> failing_gain(const TuneTrial& trial, std::size_t& verified) {
    verified = 0;
    for (int i = 0; i < kVerifiedGains; ++i) {
      const double gain = math::pow(question_.margin, static_cast<double>(i) / (kVerifiedGains - 1));
      if (!settled(trial, gain)) return gain;
      verified += family_.size();
    }
    return std::nullopt;
  }

  /// The last of the values along a way up to which `holds`.
  static double last_of(const SearchWay& way, const std::function<bool(double)>& holds) {
    const auto at_part = [&](double part) { return holds(way.value_at(part)); };
    bool all = true;  // a run beyond the first edge tells nothing
    std::map<double, bool> scan = scanned(kEdgeIntervals, [&](double part) { return all = all && at_part(part); });
    return way.value_at(find_edge(way, std::move(scan), at_part, way.resolution, false).stable.value_or(0.0));
  }

  TuneMargins margins(const TuneTrial& choice) {
    TuneMargins margins;
    const double most = ranges_.stiffness.to / choice.stiffness;
    if (most > question_.margin) {
      const SearchWay gains{.range = {question_.margin, std::min(kMostGain, most), true}, .resolution = kResolution};
      margins.gain = last_of(gains, [&](double gain) { return settled(choice, gain); });
    }
    const Scenario scenario = at(choice, choice.stiffness, family_[0]).scenario;
    if (has_device(scenario)) {
      const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
      const SearchWay delays{.range = {0.0, kMostDelay}, .whole = whole, .resolution = 0.02 / kMostDelay};
      margins.delay_samples = last_of(delays, [&](double more) {
        return settled(choice, 1.0, fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more));
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

  TuneMetrics spread(const TuneTrial& choice) {
    const LoadedScenario own = at(choice, choice.stiffness, family_[0]);
    std::vector<TuneMetrics> all = metrics_of(choice, family_of(own, FamilyOver::seeds));
    all.push_back(choice.metrics);
    TuneMetrics spread;
    for (const auto& [name, value] : choice.metrics) {
      std::vector<double> values;
      for (const TuneMetrics& metrics : all)
        if (const auto found = metrics.find(name); found != metrics.end()) values.push_back(found->second);
      if (values.size() == all.size()) spread[name] = standard_deviation(values);
    }
    return spread;
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
  /// allowed; infinite where there is none.
  std::pair<int, double> excess(const TuneTrial& trial) const {
    std::pair<int, double> found{0, 0.0};
    for (const auto& [name, bound] : question_.limits) {
      const auto value = trial.worst.find(name);
      const bool known = value != trial.worst.end() && bound.max && *bound.max > 0.0;
      const double ratio = known ? value->second / *bound.max : std::numeric_limits<double>::infinity();
      found.first += ratio > 1.0;
      found.second = std::max(found.second, ratio);
    }
    return found;
  }

  void explain(TunedLaw& law) {
    const TuneTrial* nearest = nullptr;
    for (const auto& [key, trial] : trials_)
      if (trial.limits_alone && (nearest == nullptr || excess(trial) < excess(*nearest))) nearest = &trial;
    if (nearest != nullptr) {
      law.binding = nearest->binding;
      law.why = nearest->why;
      for (const auto& [name, bound] : question_.limits) {
        const auto value = nearest->worst.find(name);
        if (value == nearest->worst.end())
          law.relax += fmt::format("drop the limit on {}, which has no value here; ", name);
        else if (bound.max && value->second > *bound.max)
          law.relax += fmt::format("{} <= {:.3g} in place of {:.3g}; ", name, value->second * 1.001, *bound.max);
        else if (bound.min && value->second < *bound.min)
          law.relax += fmt::format("{} >= {:.3g} in place of {:.3g}; ", name, value->second * 0.999, *bound.min);
      }
      law.relax += fmt::format("then K = {:.4g} N/m{}", nearest->stiffness, setting_text(*nearest));
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
      if (!settled(trial, 1.0)) continue;
      const double gain = last_of(gains, [&](double g) { return settled(trial, g); });
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
  std::shared_ptr<const PointShell> shell_;
  std::vector<FamilyMember> family_;      ///< the scene's own first
  std::optional<double> springs_lambda_;  ///< of springs, which their place does not change
  std::map<std::pair<TuneSetting, double>, TuneTrial> trials_;
  std::size_t runs_ = 0;
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;  ///< just beyond the best
  TuneTrial end_;     ///< beyond the range, of which only the reason counts
};

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  return Tuner(question, algorithm).tuned();
}

}  // namespace hapbench
