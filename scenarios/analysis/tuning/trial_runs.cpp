#include "scenarios/analysis/tuning/trial_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

/// Returns " (NAME)" of a variant; empty for the scene itself.
std::string with(const SceneVariant& variant) {
  return variant.overrides.empty() ? "" : fmt::format(" ({})", variant.name);
}

std::string verdict_with(const RunStability& run, const SceneVariant& variant) {
  return std::string(run_verdict_name(run.verdict)) + with(variant);
}

/// Returns the rule for a run of a variant. The variants "hands" only test the stability of the loop: in these
/// variants a tool at rest is stable, even if it rests because a softer hand is too weak to move it along.
StabilityRule rule_for(const Scenario& scenario, const SceneVariant& variant) {
  StabilityRule rule = rule_of(scenario);
  rule.judges_progress = variant.family != "hands";
  return rule;
}

/// Stores the largest and the smallest value of a limited metric over the variants in the trial. Stores no value if the
/// metric has no value in one of the runs.
void note_extremes(TuneTrial& trial, const std::string& name, std::span<const MetricValues> metrics,
                   std::span<const SceneVariant> variants) {
  trial.largest.erase(name);
  trial.smallest.erase(name);
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const auto value = value_in(metrics[i], name);
    if (!value) {
      trial.largest.erase(name);
      trial.smallest.erase(name);
      trial.missing[name] = name + " has no value" + with(variants[i]);
      return;
    }
    const ExtremeValue here{*value, fmt::format("{} {:.4g}{}", name, *value, with(variants[i]))};
    ExtremeValue& largest = trial.largest.try_emplace(name, here).first->second;
    ExtremeValue& smallest = trial.smallest.try_emplace(name, here).first->second;
    if (*value > largest.value) largest = here;
    if (*value < smallest.value) smallest = here;
  }
}

}  // namespace

TrialRuns::TrialRuns(const TuneQuestion& question, const std::string& algorithm)
    : question_(question),
      algorithm_(algorithm),
      ranges_(tune_ranges(question, algorithm)),
      over_hands_(std::ranges::find(question.families, "hands") != question.families.end()),
      variants_({{"the scene's own run"}}) {
  // Build the surface, and collect the variants and the largest stiffness eigenvalue of springs in permanent contact.
  const LoadedScenario own = load({}, ranges_.stiffness.from);
  shell_ = make_shell(own.scenario, own.files);
  for (const std::string& family : question_.families) {
    for (SceneVariant& variant : scene_variants(own, family)) {
      variant.family = family;
      variants_.push_back(std::move(variant));
    }
  }
  if (has_permanent_springs(own.scenario)) springs_lambda_ = stiffness_eigenvalues(own.scenario)[2];
}

std::vector<std::string> TrialRuns::overrides(const TuneSetting& setting, double stiffness) const {
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

LoadedScenario TrialRuns::load(const TuneSetting& setting, double stiffness, std::size_t variant,
                               const std::string& more) const {
  std::vector<std::string> fields = overrides(setting, stiffness);
  fields.insert(fields.end(), variants_[variant].overrides.begin(), variants_[variant].overrides.end());
  if (!more.empty()) fields.push_back(more);
  return load_scenario(question_.scenario, fields);
}

// ---- Linear loops

/// Returns the name of the first hand with which the loop in contact is unstable at a stiffness between K and `highest`
/// [N/m]; the scene's own loop has an empty name. Returns no value if all loops are stable. Samples the stiffness
/// downwards from `highest` in steps of 10 %, and at K itself.
std::optional<std::string> TrialRuns::unstable_loop(Scenario scenario, const ContactOfTrial& contact, double K,
                                                    double highest, bool over_hands) const {
  constexpr double kStiffnessStep = 1.1;
  for (double at = highest;; at = std::max(K, at / kStiffnessStep)) {
    scenario.rendering.stiffness = at;
    const std::vector<NamedLoop> loops = loops_in_contact(scenario, contact, over_hands);
    if (loops.empty()) return std::nullopt;
    for (const auto& [hand, matrices] : loops)
      if (!is_stable_loop(matrices)) return hand;
    if (!(at > K)) return std::nullopt;
  }
}

std::vector<NamedLoop> TrialRuns::loops_in_contact(const Scenario& scenario, const ContactOfTrial& contact,
                                                   bool over_hands) const {
  if (springs_lambda_) return wall_loops(scenario, *springs_lambda_, over_hands);
  if (!contact.linear) return {};
  return contact_loops(scenario, scaled(*contact.linear, contact.rendering, scenario.rendering), over_hands);
}

/// Returns the contact of a settled run, linearised at the equilibrium of the tool. The search for the equilibrium
/// starts from the state in the last step in contact. Returns no contact if the contact does not persist, because there
/// is then no linear loop.
ContactOfTrial TrialRuns::contact_of(const CheckedScenario& scene, const RunStability& run) const {
  ContactOfTrial contact;
  contact.rendering = scene.scenario().rendering;
  if (springs_lambda_ || !contact_lasts(run.settled, scene.scenario()) || !has_linear_loop(scene.scenario()) ||
      has_multi_rate_contacts(scene.scenario()))
    return contact;
  const auto at_rest = linear_contact(scene, shell_, *run.settled.last_contact);
  if (at_rest && at_rest->is_equilibrium) contact.linear = at_rest->contact;
  return contact;
}

std::optional<TuneFailure> TrialRuns::loop_failure(const TuneTrial& trial, std::size_t variant,
                                                   const ContactOfTrial& contact) const {
  const double K = trial.stiffness, G = question_.margin;
  const Scenario scenario = load(trial.setting, K, variant).scenario;
  const auto hand = unstable_loop(scenario, contact, K, G * K, over_hands_);
  if (!hand) return std::nullopt;
  const std::string own = springs_lambda_ ? "the device alone" : variants_[variant].name;
  const std::string who = hand->empty() ? own : *hand + with(variants_[variant]);
  TuneFailure failure{"margin", fmt::format("between K and {:g} K the contact loop is unstable with {}", G, who)};
  failure.variant = hand->empty() && variant == 0 ? "" : who;
  // A loop that is unstable only with other hands fails because of the variant set "hands".
  const bool is_own = unstable_loop(scenario, contact, K, G * K, false).has_value();
  failure.family = is_own ? variants_[variant].family : "hands";
  failure.unstable_at_K = unstable_loop(scenario, contact, K, K, over_hands_).has_value();
  failure.variant_index = variant;
  return failure;
}

// ---- Motions

bool TrialRuns::is_stable_at_K(const TuneTrial& trial, std::size_t variant, MotionOfVariant& motion) const {
  const CheckedScenario scene = checked(load(trial.setting, trial.stiffness, variant));
  motion.at_K = stability_of(scene, shell_, rule_for(scene.scenario(), variants_[variant]));
  if (!is_stable(motion.at_K.verdict)) return false;
  motion.contact = contact_of(scene, motion.at_K);
  return true;
}

bool TrialRuns::is_stable_at_margin(const TuneTrial& trial, std::size_t variant, MotionOfVariant& motion) const {
  const CheckedScenario scene = checked(load(trial.setting, question_.margin * trial.stiffness, variant));
  motion.at_margin = stability_of(scene, shell_, rule_for(scene.scenario(), variants_[variant]));
  return is_stable(motion.at_margin.verdict);
}

std::optional<TuneFailure> TrialRuns::motion_failure(const TuneTrial& trial, std::size_t variant,
                                                     const MotionOfVariant& motion) const {
  const auto failure = [&](const char* binding, const std::string& where, const RunStability& run) {
    TuneFailure failed{binding, where + verdict_with(run, variants_[variant])};
    failed.variant = variant > 0 ? variants_[variant].name : "";
    failed.family = variants_[variant].family;
    failed.verdict = run_verdict_name(run.verdict);
    failed.variant_index = variant;
    return failed;
  };
  if (const RunVerdict at_K = motion.at_K.verdict; !is_stable(at_K)) {
    TuneFailure failed = failure("settled", "at K: ", motion.at_K);
    failed.too_soft = at_K >= RunVerdict::thrown_out && at_K <= RunVerdict::went_through;
    return failed;
  }
  if (!is_stable(motion.at_margin.verdict))
    return failure("margin", fmt::format("at {:g} K: ", question_.margin), motion.at_margin);
  // For springs in permanent contact, the loop was checked before the runs.
  return springs_lambda_ ? std::nullopt : loop_failure(trial, variant, motion.contact);
}

std::string TrialRuns::failure_of(const TuneTrial& trial, std::size_t variant, const std::string& more) const {
  const double K = trial.stiffness;
  const CheckedScenario scene = checked(load(trial.setting, K, variant, more));
  if (unstable_loop(scene.scenario(), trial.contact, K, scene.scenario().rendering.stiffness, over_hands_))
    return "the contact loop is unstable" + with(variants_[variant]);
  const RunStability run = stability_of(scene, shell_, rule_for(scene.scenario(), variants_[variant]));
  return is_stable(run.verdict) ? "" : verdict_with(run, variants_[variant]);
}

std::optional<TuneFailure> TrialRuns::vibration(const TuneSetting& setting, double stiffness) const {
  const CheckedScenario scene = checked(load(setting, stiffness));
  const RunStability run = stability_of(scene, shell_, rule_for(scene.scenario(), variants_[0]));
  if (run.verdict == RunVerdict::vibrating || run.verdict == RunVerdict::diverged)
    return TuneFailure{"settled", verdict_with(run, variants_[0])};
  for (const Diagnosed& number : run_with_shell(scene, shell_, Diagnose::low_vibration).low_vibration)
    if (number.value > number.threshold) return TuneFailure{number.rule, number.says};
  return std::nullopt;
}

std::vector<Diagnosed> TrialRuns::findings(const TuneSetting& setting, double stiffness) const {
  return *run_with_shell(checked(load(setting, stiffness)), shell_, Diagnose::everything).diagnosis;
}

// ---- Metrics

MetricValues TrialRuns::metrics_of(const Result& run) const {
  MetricValues metrics;
  const auto add = [&](const std::string& name) {
    if (const auto value = number_of(run.metrics, name)) metrics[name] = *value;
  };
  for (const char* name : kTuneMetrics) add(name);
  for (const auto& [name, bound] : question_.limits) add(name);
  return metrics;
}

MetricValues TrialRuns::metrics_in(const TuneTrial& trial, std::size_t variant) const {
  return metrics_of(run_with_shell(checked(load(trial.setting, trial.stiffness, variant)), shell_));
}

void TrialRuns::note_metrics(TuneTrial& trial, std::span<const MetricValues> metrics) const {
  for (const auto& [name, bound] : question_.limits) note_extremes(trial, name, metrics, variants_);
}

void TrialRuns::measure(TuneTrial& trial) const {
  trial.is_measured = true;
  const CheckedScenario scene = checked(load(trial.setting, trial.stiffness));
  const Result run = run_with_shell(scene, shell_, Diagnose::low_vibration);
  trial.metrics = metrics_of(run);
  if (const Metric* depth = find_metric(run.metrics, "inside_max_m"))
    trial.depth_within = depth->tolerance().value_or(std::numeric_limits<double>::infinity());
  for (const Diagnosed& number : run.low_vibration)
    trial.largest.insert_or_assign(number.rule, ExtremeValue{number.value, number.says});
  // The verdict on a run that ends early because the tool rests comes from fewer poses of the tool than the outcome of
  // the whole run. The depth of a tool near the threshold of the outcome may then differ by the error of its search.
  if (!trial.failure && run.end.outcome == Outcome::went_through) {
    trial.settled = false;
    trial.failure = TuneFailure{"settled", fmt::format("at K: {}", outcome_name(run.end.outcome))};
    trial.failure->verdict = outcome_name(run.end.outcome);
    trial.failure->too_soft = true;
  }
  // Forces below half the resolution of the device are rounded to zero.
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scene.scenario().device);
  const double smallest = device != nullptr ? 0.5 * device->force_step : 0.0;
  const double largest = number_of(run.metrics, "force_max_N").value_or(0.0);
  if (!(largest > smallest)) {
    trial.failure =
        TuneFailure{"no_force", fmt::format("no force is rendered: the largest force of the law is {:.3g} N", largest)};
    trial.failure->too_soft = true;
  }
  // A run beyond the limit of explicit friction is a numerical artefact: its metrics mean nothing.
  if (const double steps = number_of(run.metrics, "explicit_friction_rows_beyond").value_or(0.0); steps > 0.0)
    trial.failure = TuneFailure{
        "friction",
        fmt::format("explicit integration of friction is unstable in the run (number of unstable steps: {:g})", steps)};
  note_metrics(trial, {&trial.metrics, 1});
}

}  // namespace hapbench
