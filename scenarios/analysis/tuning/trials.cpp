#include "scenarios/analysis/tuning/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Returns " (NAME)" of a variant; empty for the scene itself.
std::string with(const SceneVariant& variant) {
  return variant.overrides.empty() ? "" : fmt::format(" ({})", variant.name);
}

std::string verdict_with(const RunStability& run, const SceneVariant& variant) {
  return std::string(run_verdict_name(run.verdict)) + with(variant);
}

/// Stores the worst value of a limited metric over the variants in the trial. Stores no value if the metric has no
/// value in one of the runs.
void note_worst(TuneTrial& trial, const std::string& name, const MetricBound& bound,
                std::span<const TuneMetrics> metrics, std::span<const SceneVariant> variants) {
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const auto value = value_in(metrics[i], name);
    if (!value) {
      trial.worst.erase(name);
      trial.worst_text[name] = name + " has no value" + with(variants[i]);
      return;
    }
    const auto [worst, is_first] = trial.worst.try_emplace(name, *value);
    const bool is_worse = bound.max ? *value > worst->second : *value < worst->second;
    if (!is_first && !is_worse) continue;
    worst->second = *value;
    trial.worst_text[name] = fmt::format("{} {:.4g}{}", name, *value, with(variants[i]));
  }
}

/// Returns far / near, at least slightly above 1; infinite if `far` or `near` is not above 0.
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
      requires_low_vibration_(question.limits.empty()),
      limits_(question.limits),
      variants_({{"the scene's own run"}}),
      smallest_unstable_(kInfinite),
      cap_(ranges_.stiffness.to) {
  // Collect the variants and the stiffness of springs in permanent contact.
  const LoadedScenario own = load({}, ranges_.stiffness.from);
  shell_ = make_shell(own.scenario, own.files);
  for (const std::string& set : question_.families)
    for (SceneVariant& variant : scene_variants(own, set)) variants_.push_back(std::move(variant));
  if (has_permanent_springs(own.scenario)) springs_lambda_ = stiffness_eigenvalues(own.scenario)[2];
  // If the user gave no limits, use the thresholds of the low-vibration rules of the diagnosis.
  if (requires_low_vibration_)
    for (const Diagnosed& rule : diagnosis_rules(requires_low_vibration_)) limits_[rule.rule].max = rule.threshold;
  end_.fail("range", "the end of the search range");
}

// ---- The question

std::vector<std::string> Trials::overrides(const TuneSetting& setting, double stiffness) const {
  std::vector<std::string> fields = question_.overrides;
  fields.push_back("rendering.algorithm=" + algorithm_);
  if (setting.damping_ratio) {
    fields.emplace_back("rendering.damping_N_s_per_m=null");
    fields.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
  }
  if (setting.mass) fields.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
  if (!setting.filter.empty()) fields.push_back("device.velocity_filter=" + setting.filter);
  fields.push_back(fmt::format("{}={}", kStiffnessPath, stiffness));
  return fields;
}

LoadedScenario Trials::load(const TuneSetting& setting, double stiffness) const {
  return load(setting, stiffness, variants_.front());
}

LoadedScenario Trials::load(const TuneSetting& setting, double stiffness, const SceneVariant& variant,
                            const std::string& more) const {
  std::vector<std::string> fields = overrides(setting, stiffness);
  fields.insert(fields.end(), variant.overrides.begin(), variant.overrides.end());
  if (!more.empty()) fields.push_back(more);
  return load_scenario(question_.scenario, fields);
}

// ---- Trials

TuneTrial& Trials::mutable_trial(const TuneSetting& setting, double stiffness) {
  const auto [entry, is_new] = all_.try_emplace({setting, stiffness});
  TuneTrial& trial = entry->second;
  if (!is_new) return trial;
  trial.setting = setting;
  trial.algorithm = algorithm_;
  trial.stiffness = stiffness;
  judge(trial);
  return trial;
}

const TuneTrial& Trials::trial_at(const TuneSetting& setting, double stiffness) {
  return mutable_trial(setting, stiffness);
}

const TuneTrial& Trials::beyond(const TuneSetting& setting, double K) {
  return K <= cap_ ? trial_at(setting, K) : end_;
}

void Trials::evaluate_and_measure(const TuneSetting& setting, double stiffness) {
  TuneTrial& trial = mutable_trial(setting, stiffness);
  if (trial.settled) measure(trial);
}

void Trials::measure(TuneTrial& trial) {
  if (!trial.metrics.empty()) return;
  in_parallel(1, [&](std::size_t) {
    trial.metrics = metrics_of(run_with_shell(checked(load(trial.setting, trial.stiffness)), shell_));
  });
}

std::optional<Failing> Trials::first_failing(const TuneTrial& trial, std::size_t count,
                                             const std::function<std::string(std::size_t run)>& more) {
  const double lambda = lambda_of(trial), K = trial.stiffness;
  std::vector<std::string> why(count);
  in_parallel(count, [&](std::size_t i) {
    // Check the linear loop in contact, then run.
    const SceneVariant& variant = variants_[i % variants_.size()];
    const CheckedScenario scene = checked(load(trial.setting, K, variant, more(i)));
    if (unstable_loop(scene.scenario(), lambda, K, scene.scenario().rendering.stiffness)) {
      why[i] = "the contact loop is unstable" + with(variant);
      return;
    }
    const RunStability run = stability_of(scene, shell_, rule_of(scene.scenario()));
    if (!is_stable(run.verdict)) why[i] = verdict_with(run, variant);
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

// ---- Evaluation of the constraints, the cheapest first

void Trials::judge(TuneTrial& trial) {
  if (springs_lambda_ && !judge_loop(trial, variants_[0], *springs_lambda_, "the device alone")) return;
  if (runs_ >= kMaxTuneRuns) {
    trial.fail("runs", fmt::format("the search ended after {} runs", runs_));
    return;
  }
  judge_motion(trial, 0, 1);
  if (trial.feasible() && variants_.size() > 1) judge_motion(trial, 1, variants_.size());
  if (trial.feasible()) judge_limits(trial);
}

/// Returns the first hand with which the loop in contact is unstable at a stiffness between K and `most` [N/m]; empty
/// if all loops are stable. Samples the stiffness in steps of 10 %.
std::optional<std::string> Trials::unstable_loop(Scenario scenario, double lambda, double K, double most) const {
  constexpr double kStiffnessStep = 1.1;
  for (double at = most; lambda > 0.0 && at * kStiffnessStep > K; at /= kStiffnessStep) {
    scenario.rendering.stiffness = at;
    for (const auto& [hand, step] : contact_step_matrices(scenario, lambda, over_hands_))
      if (!is_stable_step(step)) return hand;
  }
  return std::nullopt;
}

/// Returns false, and fails the trial, if the loop of a variant in contact is unstable between K and G K.
bool Trials::judge_loop(TuneTrial& trial, const SceneVariant& variant, double lambda,
                        const std::string& own_hand) const {
  const double K = trial.stiffness;
  const auto hand = unstable_loop(load(trial.setting, K, variant).scenario, lambda, K, question_.margin * K);
  if (!hand) return true;
  trial.fail("margin", fmt::format("between K and {:g} K the contact loop is unstable with {}", question_.margin,
                                   hand->empty() ? own_hand : *hand));
  return false;
}

/// Runs the variants [first, last) at K and at G K. Fails the trial at the first run that is not settled.
void Trials::judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
  std::vector<RunStability> judged(2 * (last - first));  // for each variant: the verdict at K, then at G K
  in_parallel(judged.size(), [&](std::size_t job) {
    const double gain = job % 2 != 0 ? question_.margin : 1.0;
    const CheckedScenario scene = checked(load(trial.setting, gain * trial.stiffness, variants_[first + job / 2]));
    judged[job] = stability_of(scene, shell_, rule_of(scene.scenario()));
  });
  if (first == 0) trial.lambda_max = judged[0].settled.lambda_max;
  for (std::size_t i = first; i < last; ++i) {
    const RunStability &at_K = judged[2 * (i - first)], &at_GK = judged[2 * (i - first) + 1];
    if (!is_stable(at_K.verdict)) {
      trial.too_soft = at_K.verdict >= RunVerdict::thrown_out && at_K.verdict <= RunVerdict::went_through;
      return trial.fail("settled", verdict_with(at_K, variants_[i]));
    }
    trial.settled = true;
    if (!is_stable(at_GK.verdict))
      return trial.fail("margin", fmt::format("at {:g} K: {}", question_.margin, verdict_with(at_GK, variants_[i])));
    // For springs in permanent contact, judge() checked the loop before the runs.
    if (!springs_lambda_ && !judge_loop(trial, variants_[i], at_K.settled.lambda_max, variants_[i].name)) return;
  }
}

/// Measures the limited metrics over the variants. Fails the trial at the first violated limit.
void Trials::judge_limits(TuneTrial& trial) {
  // The low-vibration rules apply only to the run of the scene itself. Limits of the user apply to all variants.
  std::vector<TuneMetrics> metrics(requires_low_vibration_ ? 1 : variants_.size());
  in_parallel(metrics.size(), [&](std::size_t i) {
    const CheckedScenario scene = checked(load(trial.setting, trial.stiffness, variants_[i]));
    const Result run = run_with_shell(scene, shell_);
    metrics[i] = metrics_of(run);
    if (!requires_low_vibration_) return;
    for (const Diagnosed& number : low_vibration_numbers(scene.loaded(), run)) {
      trial.worst[number.rule] = number.value;
      trial.worst_text[number.rule] = number.says;
    }
  });
  trial.metrics = metrics[0];
  for (const auto& [name, bound] : question_.limits) note_worst(trial, name, bound, metrics, variants_);
  judge_worst(trial);
}

/// Fails the trial at the first violated limit. Precondition: TuneTrial::worst is filled.
void Trials::judge_worst(TuneTrial& trial) const {
  const TuneMetrics violated = violated_limits(trial);
  trial.binding.clear();
  trial.too_soft = false;
  trial.limits_alone = !violated.empty();
  if (violated.empty()) return;
  const std::string& name = violated.begin()->first;
  const bool is_depth = name.starts_with("inside") || name.starts_with("depth");
  trial.too_soft = limits_.at(name).max && trial.worst.contains(name) && is_depth;
  trial.fail(name, trial.worst_text.at(name));
}

// ---- Limits on metrics

TuneMetrics Trials::violated_limits(const TuneTrial& trial) const {
  TuneMetrics violated;
  for (const auto& [name, bound] : limits_) {
    const auto value = value_in(trial.worst, name);
    if (!value && !requires_low_vibration_) violated[name] = kInfinite;
    if (value && bound.min && *value < *bound.min) violated[name] = ratio_beyond(*bound.min, *value);
    if (value && bound.max && *value > *bound.max) violated[name] = ratio_beyond(*value, *bound.max);
  }
  return violated;
}

std::pair<std::size_t, double> Trials::excess(const TuneTrial& trial) const {
  const TuneMetrics violated = violated_limits(trial);
  double largest = 0.0;
  for (const auto& [name, times] : violated) largest = std::max(largest, times);
  return {violated.size(), largest};
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
  smallest_unstable_ = std::min(smallest_unstable_, K);
}

void Trials::set_cap(double cap, std::string constraint, std::string reason) {
  cap_ = cap;
  end_.fail(std::move(constraint), std::move(reason));
}

}  // namespace hapbench
