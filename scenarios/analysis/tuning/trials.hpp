#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"

/// The trials of tune: a setting at a stiffness, run with each member of a family and judged by stability and limits.
namespace hapbench {

inline std::string with(const FamilyMember& member) {
  return member.overrides.empty() ? "" : fmt::format(" ({})", member.name);
}

inline std::string verdict_with(const RunStability& run, const FamilyMember& member) {
  return std::string(run_verdict_name(run.verdict)) + with(member);
}

/// Notes the worst value of a limited metric over the family; empty where it has none in some run.
inline void note_worst(TuneTrial& trial, const std::string& name, const MetricBound& bound,
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
  /// Allowed bounds of metrics: the limits of the question, tightened by the known errors.
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
    if (is_quiet)
      for (const Diagnosed& rule : diagnosis_rules(is_quiet)) limits[rule.rule].max = rule.threshold;
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
  /// The trial, or above `cap` the end, which is not feasible.
  const TuneTrial& beyond(const TuneSetting& setting, double K) { return K <= cap ? tried(setting, K) : end; }
  bool feasible(const TuneSetting& setting, double K) { return beyond(setting, K).feasible(); }

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
  /// The trial with the least excess among those that fail nothing but limits; null if there is none.
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
      // With springs the loop was judged before the runs (tried).
      if (!springs_lambda && !judge_loop(trial, family[i], at_K.settled.lambda_max, family[i].name)) return;
    }
  }

  /// Runs the family for the metrics that are limited, and finds the first limit that is not kept.
  void judge_limits(TuneTrial& trial) {
    // Whether a run is quiet is judged by the scene's own run, limits that the user gives by those of all members.
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

}  // namespace hapbench
