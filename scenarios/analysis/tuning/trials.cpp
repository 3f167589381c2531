#include "scenarios/analysis/tuning/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Returns " (NAME)" of a member; empty for the scene's own run.
std::string with(const FamilyMember& member) {
  return member.overrides.empty() ? "" : fmt::format(" ({})", member.name);
}

std::string verdict_with(const RunStability& run, const FamilyMember& member) {
  return std::string(run_verdict_name(run.verdict)) + with(member);
}

/// Notes the worst value of a limited metric over the family; none if a run has no value.
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

/// Returns the ratio of a value to its limit, or of the limit to the value, whichever is above 1; infinite if one of
/// the two is not above 0.
double ratio_beyond(double far, double near) {
  if (!(far > 0.0 && near > 0.0)) return kInfinite;
  return std::max(far / near, std::nextafter(1.0, 2.0));
}

}  // namespace

Trials::Trials(const TuneQuestion& question, const std::string& algorithm)
    : question_(question),
      algorithm_(algorithm),
      ranges_(tune_ranges(question, algorithm)),
      over_hands_(std::ranges::find(question.families, "hands") != question.families.end()),
      is_quiet_(question.limits.empty()),
      limits_(question.limits),
      family_({{"the scene's own run"}}),
      refuted_(kInfinite),
      cap_(ranges_.stiffness.to) {
  const LoadedScenario own = load({}, ranges_.stiffness.from);
  shell_ = make_shell(own.scenario, own.files);
  for (const std::string& family : question_.families)
    for (FamilyMember& member : family_of(own, family)) family_.push_back(std::move(member));
  if (springs_stay(own.scenario)) springs_lambda_ = stiffness_eigenvalues(own.scenario)[2];
  if (is_quiet_)
    for (const Diagnosed& rule : diagnosis_rules(is_quiet_)) limits_[rule.rule].max = rule.threshold;
  end_.fail("range", "the end of the search range");
}

// ---- The question

std::vector<std::string> Trials::overrides(const TuneSetting& setting, double stiffness) const {
  std::vector<std::string> words = question_.overrides;
  words.push_back("rendering.algorithm=" + algorithm_);
  if (setting.damping_ratio) {
    words.push_back("rendering.damping_N_s_per_m=null");
    words.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
  }
  if (setting.mass) words.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
  if (!setting.filter.empty()) words.push_back("device.velocity_filter=" + setting.filter);
  words.push_back(fmt::format("{}={}", kStiffnessPath, stiffness));
  return words;
}

LoadedScenario Trials::load(const TuneSetting& setting, double stiffness) const {
  return load(setting, stiffness, family_.front());
}

LoadedScenario Trials::load(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                            const std::string& more) const {
  std::vector<std::string> fields = overrides(setting, stiffness);
  fields.insert(fields.end(), member.overrides.begin(), member.overrides.end());
  if (!more.empty()) fields.push_back(more);
  return load_scenario(question_.scenario, fields);
}

// ---- Trials

TuneTrial& Trials::mutable_trial(const TuneSetting& setting, double stiffness) {
  const auto [place, is_new] = all_.try_emplace({setting, stiffness});
  TuneTrial& trial = place->second;
  if (!is_new) return trial;
  trial.setting = setting;
  trial.algorithm = algorithm_;
  trial.stiffness = stiffness;
  judge(trial);
  return trial;
}

const TuneTrial& Trials::tried(const TuneSetting& setting, double stiffness) {
  return mutable_trial(setting, stiffness);
}

const TuneTrial& Trials::beyond(const TuneSetting& setting, double K) {
  return K <= cap_ ? tried(setting, K) : end_;
}

void Trials::try_and_measure(const TuneSetting& setting, double stiffness) {
  TuneTrial& trial = mutable_trial(setting, stiffness);
  if (trial.settled) measure(trial);
}

void Trials::measure(TuneTrial& trial) {
  if (!trial.metrics.empty()) return;
  in_parallel(1, [&](std::size_t) {
    trial.metrics = metrics_of(run_with_shell(load(trial.setting, trial.stiffness), shell_));
  });
}

std::optional<Failing> Trials::first_failing(const TuneTrial& trial, std::size_t count,
                                             const std::function<std::string(std::size_t run)>& more) {
  const double lambda = lambda_of(trial), K = trial.stiffness;
  std::vector<std::string> why(count);
  in_parallel(count, [&](std::size_t i) {
    const FamilyMember& member = family_[i % family_.size()];
    const LoadedScenario loaded = load(trial.setting, K, member, more(i));
    if (unstable_loop(loaded.scenario, lambda, K, loaded.scenario.rendering.stiffness)) {
      why[i] = "the contact loop is unstable" + with(member);
      return;
    }
    const RunStability run = stability_of(loaded, shell_, rule_of(loaded.scenario));
    if (!is_stable(run.verdict)) why[i] = verdict_with(run, member);
  });
  for (std::size_t i = 0; i < count; ++i)
    if (!why[i].empty()) return Failing{i, why[i]};
  return std::nullopt;
}

void Trials::in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  runs_ += count;
  for_each_job(count, {question_.threads, ""}, job);
  if (question_.on_runs) question_.on_runs(runs_);
}

TuneMetrics Trials::metrics_of(const Result& run) const {
  TuneMetrics metrics;
  const auto add = [&](const std::string& name) {
    if (const auto value = number_of(run.metrics, name)) metrics[name] = *value;
  };
  for (const char* name : kTuneMetrics) add(name);
  for (const auto& [name, bound] : question_.limits) add(name);
  return metrics;
}

// ---- Judgement, in the order of cost

void Trials::judge(TuneTrial& trial) {
  if (springs_lambda_ && !judge_loop(trial, family_[0], *springs_lambda_, "the device alone")) return;
  if (runs_ >= kMostTuneRuns) {
    trial.fail("runs", fmt::format("the search ended after {} runs", runs_));
    return;
  }
  judge_motion(trial, 0, 1);
  if (trial.feasible() && family_.size() > 1) judge_motion(trial, 1, family_.size());
  if (trial.feasible()) judge_limits(trial);
}

/// Returns the hand with which the loop is unstable at some stiffness from K to `most`; empty if there is none.
std::optional<std::string> Trials::unstable_loop(Scenario scenario, double lambda, double K, double most) const {
  constexpr double kStride = 1.1;
  for (double at = most; lambda > 0.0 && at * kStride > K; at /= kStride) {
    scenario.rendering.stiffness = at;
    for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands_))
      if (!is_stable_step(step)) return hand;
  }
  return std::nullopt;
}

/// Returns false if the loop of a member in contact is unstable up to the margin.
bool Trials::judge_loop(TuneTrial& trial, const FamilyMember& member, double lambda,
                        const std::string& own_hand) const {
  const double K = trial.stiffness;
  const auto hand = unstable_loop(load(trial.setting, K, member).scenario, lambda, K, question_.margin * K);
  if (!hand) return true;
  trial.fail("margin", fmt::format("between K and {:g} K the contact loop is unstable with {}", question_.margin,
                                   hand->empty() ? own_hand : *hand));
  return false;
}

/// Runs the members from `first` to before `last` at K and at G K, and finds the first that is not settled.
void Trials::judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
  std::vector<RunStability> judged(2 * (last - first));  // of each member at K and at G K
  in_parallel(judged.size(), [&](std::size_t job) {
    const double gain = job % 2 != 0 ? question_.margin : 1.0;
    const LoadedScenario loaded = load(trial.setting, gain * trial.stiffness, family_[first + job / 2]);
    judged[job] = stability_of(loaded, shell_, rule_of(loaded.scenario));
  });
  if (first == 0) trial.lambda_max = judged[0].settled.lambda_max;
  for (std::size_t i = first; i < last; ++i) {
    const RunStability &at_K = judged[2 * (i - first)], &at_GK = judged[2 * (i - first) + 1];
    if (!is_stable(at_K.verdict)) {
      trial.too_soft = at_K.verdict >= RunVerdict::thrown_out && at_K.verdict <= RunVerdict::went_through;
      return trial.fail("settled", verdict_with(at_K, family_[i]));
    }
    trial.settled = true;
    if (!is_stable(at_GK.verdict))
      return trial.fail("margin", fmt::format("at {:g} K: {}", question_.margin, verdict_with(at_GK, family_[i])));
    // With springs the loop was judged before the runs (judge).
    if (!springs_lambda_ && !judge_loop(trial, family_[i], at_K.settled.lambda_max, family_[i].name)) return;
  }
}

/// Measures the limited metrics over the family, and finds the first limit that is violated.
void Trials::judge_limits(TuneTrial& trial) {
  // Low vibration is judged by the scene's own run, limits of the user by the runs of all members.
  std::vector<TuneMetrics> metrics(is_quiet_ ? 1 : family_.size());
  in_parallel(metrics.size(), [&](std::size_t i) {
    const LoadedScenario loaded = load(trial.setting, trial.stiffness, family_[i]);
    const Result run = run_with_shell(loaded, shell_);
    metrics[i] = metrics_of(run);
    if (!is_quiet_) return;
    for (const Diagnosed& number : quiet_numbers(loaded, run)) {
      trial.worst[number.rule] = number.value;
      trial.worst_text[number.rule] = number.says;
    }
  });
  trial.metrics = metrics[0];
  for (const auto& [name, bound] : question_.limits) note_worst(trial, name, bound, metrics, family_);
  judge_worst(trial);
}

/// Notes the first violated limit. Precondition as for broken_limits().
void Trials::judge_worst(TuneTrial& trial) const {
  const TuneMetrics broken = broken_limits(trial);
  trial.binding.clear();
  trial.too_soft = false;
  trial.limits_alone = !broken.empty();
  if (broken.empty()) return;
  const std::string& name = broken.begin()->first;
  const bool is_depth = name.starts_with("inside") || name.starts_with("depth");
  trial.too_soft = limits_.at(name).max && trial.worst.contains(name) && is_depth;
  trial.fail(name, trial.worst_text.at(name));
}

// ---- Limits on metrics

TuneMetrics Trials::broken_limits(const TuneTrial& trial) const {
  TuneMetrics broken;
  for (const auto& [name, bound] : limits_) {
    const auto value = value_in(trial.worst, name);
    if (!value && !is_quiet_) broken[name] = kInfinite;
    if (value && bound.min && *value < *bound.min) broken[name] = ratio_beyond(*bound.min, *value);
    if (value && bound.max && *value > *bound.max) broken[name] = ratio_beyond(*value, *bound.max);
  }
  return broken;
}

std::pair<std::size_t, double> Trials::excess(const TuneTrial& trial) const {
  const TuneMetrics broken = broken_limits(trial);
  double largest = 0.0;
  for (const auto& [name, times] : broken) largest = std::max(largest, times);
  return {broken.size(), largest};
}

const TuneTrial* Trials::nearest() const {
  const TuneTrial* nearest = nullptr;
  for (const auto& [key, trial] : all_)
    if (trial.limits_alone && (nearest == nullptr || excess(trial) < excess(*nearest))) nearest = &trial;
  return nearest;
}

bool Trials::tighten_limits(const TuneTrial& choice) {
  bool is_beyond = false;
  for (const auto& [name, bound] : question_.limits) {
    const auto worst = value_in(choice.worst, name), error = value_in(error_, name);
    if (!worst || !error) continue;
    MetricBound& allowed = limits_[name];
    if (bound.max && *worst + *error > *bound.max) {
      allowed.max = std::min(*allowed.max * (1.0 - kTuneResolution), std::max(*bound.max - *error, 0.0));
      is_beyond = true;
    }
    if (bound.min && *worst - *error < *bound.min) {
      allowed.min = *bound.min + *error;
      is_beyond = true;
    }
  }
  if (!is_beyond) return false;
  for (auto& [key, trial] : all_)
    if (trial.limits_alone || trial.feasible()) judge_worst(trial);
  return true;
}

// ---- The largest K

void Trials::note_unstable(double K) {
  refuted_ = std::min(refuted_, K);
}

void Trials::set_cap(double cap, std::string constraint, std::string reason) {
  cap_ = cap;
  end_.fail(std::move(constraint), std::move(reason));
}

}  // namespace hapbench
