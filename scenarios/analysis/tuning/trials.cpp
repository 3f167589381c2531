#include "scenarios/analysis/tuning/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/diagnosis.hpp"

namespace hapbench {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Returns how the run of the scene itself vibrates in a trial: its verdict, or the first rule of low vibration that it
/// violates; empty if neither, as far as the trial was evaluated. `rules`: the rules with their thresholds.
std::optional<TuneFailure> vibration_of(const TuneTrial& trial, const std::map<std::string, double>& rules) {
  const auto has_verdict = [&](RunVerdict verdict) { return trial.failure->verdict == run_verdict_name(verdict); };
  if (trial.failure && trial.failure->binding == "settled" && trial.failure->variant_index == 0 &&
      (has_verdict(RunVerdict::vibrating) || has_verdict(RunVerdict::diverged)))
    return TuneFailure{"settled", trial.failure->verdict};
  for (const auto& [rule, threshold] : rules)
    if (const auto found = trial.largest.find(rule); found != trial.largest.end() && found->second.value > threshold)
      return TuneFailure{rule, found->second.text};
  return std::nullopt;
}

/// Returns the factor > 1 by which a value is beyond a limit: far / near, or the next number above 1 if rounding gives
/// a smaller quotient. Infinite if `far` or `near` is not above 0. Precondition: far > near.
double ratio_beyond(double far, double near) {
  if (!(far > 0.0 && near > 0.0)) return kInfinite;
  return std::max(far / near, std::nextafter(1.0, 2.0));
}

}  // namespace

Trials::Trials(const TuneQuestion& question, const std::string& algorithm)
    : question_(question),
      algorithm_(algorithm),
      trial_runs_(question, algorithm),
      limits_{question.limits, question.allow_vibration} {
  for (const Diagnosed& rule : diagnosis_rules(RuleKind::low_vibration)) rules_[rule.rule] = rule.threshold;
}

// ---- Searches

void Trials::begin_search(TuneLimits limits) {
  change_limits(std::move(limits));
  refutations_.clear();
  exact_refutations_ = false;
  smallest_unstable_ = std::numeric_limits<double>::infinity();
}

void Trials::change_limits(TuneLimits limits) {
  limits_ = std::move(limits);
  requested_.clear();
  search_runs_ = 0;
}

void Trials::begin_purpose(std::string purpose) {
  purpose_ = std::move(purpose);
  report_runs();
}

void Trials::report_runs() const {
  if (question_.on_runs) question_.on_runs(runs_, aim_.empty() ? purpose_ : purpose_ + ", to confirm: " + aim_);
}

void Trials::recall_all() {
  for (auto& [key, trial] : all_) {
    requested_.insert(&trial);
    judge(trial);
  }
}

// ---- Trials

TuneTrial& Trials::stored_trial(const TuneSetting& setting, double stiffness) {
  const auto [entry, is_new] = all_.try_emplace({setting, stiffness});
  TuneTrial& trial = entry->second;
  if (is_new) {
    trial.setting = setting;
    trial.algorithm = algorithm_;
    trial.stiffness = stiffness;
  }
  return trial;
}

TuneTrial& Trials::mutable_trial(const TuneSetting& setting, double stiffness) {
  TuneTrial& trial = stored_trial(setting, stiffness);
  if (requested_.insert(&trial).second) {
    search_runs_ += trial.runs;  // counted as if this search had made the runs
    judge(trial);
  }
  return trial;
}

const TuneTrial& Trials::trial_at(const TuneSetting& setting, double stiffness) {
  return mutable_trial(setting, stiffness);
}

bool Trials::is_too_soft(const TuneSetting& setting, double K) {
  const TuneTrial& trial = trial_at(setting, K);
  return !trial.feasible() && evaluated(trial, Need::softness).too_soft;
}

const TuneTrial& Trials::evaluated(const TuneTrial& trial, Need need) {
  TuneTrial& own = mutable_trial(trial.setting, trial.stiffness);
  judge(own, need);
  return own;
}

const TuneTrial& Trials::with_errors(const TuneTrial& trial) {
  TuneTrial& own = mutable_trial(trial.setting, trial.stiffness);
  refine(own, Refinement::resolution);
  refine(own, Refinement::depth);
  judge(own);
  return own;
}

void Trials::evaluate_and_measure(const TuneSetting& setting, double stiffness) {
  TuneTrial& trial = mutable_trial(setting, stiffness);
  if (trial.settled) measure_scene(trial);
}

const TuneTrial* Trials::stiffest_feasible() const {
  const TuneTrial* stiffest = nullptr;
  for (const auto& [key, trial] : all_)
    if (requested_.contains(&trial) && trial.feasible() &&
        (stiffest == nullptr || trial.stiffness > stiffest->stiffness))
      stiffest = &trial;
  return stiffest;
}

std::vector<double> Trials::feasible_stiffnesses(const TuneSetting& setting) const {
  std::vector<double> stiffnesses;
  for (const auto& [key, trial] : all_)
    if (key.first == setting && requested_.contains(&trial) && trial.feasible()) stiffnesses.push_back(key.second);
  return stiffnesses;
}

std::vector<TuneTrial> Trials::feasible_trials() const {
  std::vector<TuneTrial> trials;
  for (const auto& [key, trial] : all_)
    if (requested_.contains(&trial) && trial.feasible()) trials.push_back(trial);
  return trials;
}

std::vector<const TuneTrial*> Trials::nearest(std::size_t count) {
  std::vector<const TuneTrial*> trials;
  for (const auto& [key, trial] : all_)
    if (requested_.contains(&trial) && trial.limits_alone) trials.push_back(&trial);
  const auto violates_limits_alone = [](const TuneTrial& trial) { return trial.limits_alone; };
  return smallest_excess(std::move(trials), count, /*one_per_setting=*/true, violates_limits_alone);
}

std::vector<const TuneTrial*> Trials::smallest_excess(std::vector<const TuneTrial*> trials, std::size_t count,
                                                      bool one_per_setting,
                                                      const std::function<bool(const TuneTrial&)>& counts) {
  struct Ranked {
    double excess;
    std::size_t order;  ///< index of the trial in `trials`
    const TuneTrial* trial;
  };
  const auto before = [](const Ranked& a, const Ranked& b) {
    return std::pair(a.excess, a.order) < std::pair(b.excess, b.order);
  };
  // Before a trial is evaluated further, its excess() is only a lower bound. Evaluate the trials in the order of their
  // bounds, until no other trial can be among the `count` trials with the smallest excess().
  std::vector<Ranked> bounds, exact;
  for (const TuneTrial* trial : trials) bounds.push_back({excess(*trial), bounds.size(), trial});
  std::ranges::sort(bounds, before);
  for (const Ranked& bound : bounds) {
    if (exact.size() >= count && bound.excess > exact[count - 1].excess) break;
    const TuneTrial& trial = evaluated(*bound.trial, Need::excess);
    if (!counts(trial)) continue;
    const Ranked ranked{excess(trial), bound.order, &trial};
    const auto of_setting = std::ranges::find_if(
        exact, [&](const Ranked& other) { return one_per_setting && other.trial->setting == trial.setting; });
    if (of_setting != exact.end() && before(*of_setting, ranked)) continue;
    if (of_setting != exact.end()) exact.erase(of_setting);
    exact.insert(std::ranges::upper_bound(exact, ranked, before), ranked);
  }
  trials.clear();
  for (const Ranked& ranked : exact)
    if (trials.size() < count) trials.push_back(ranked.trial);
  return trials;
}

bool Trials::is_nearer(const TuneTrial& trial, const TuneTrial& other) {
  const double best = excess(other);
  if (!trial.limits_alone || !(excess(trial) < best)) return false;
  const TuneTrial& exact = evaluated(trial, Need::excess);
  return exact.limits_alone && excess(exact) < best;
}

std::optional<Failing> Trials::first_failing(const TuneTrial& trial, std::size_t count,
                                             const std::function<std::string(std::size_t run)>& more) {
  std::vector<std::string> why(count);
  const std::size_t failing = run_until_failure(nullptr, count, [&](std::size_t i) {
    why[i] = trial_runs_.failure_of(trial, i % variant_count(), more(i));
    return why[i].empty();
  });
  if (failing == count) return std::nullopt;
  return Failing{failing, why[failing]};
}

std::vector<Diagnosed> Trials::findings(const TuneTrial& trial) {
  count_runs(1);
  return trial_runs_.findings(trial.setting, trial.stiffness);
}

std::vector<std::optional<TuneFailure>> Trials::vibrations(const TuneSetting& setting,
                                                           const std::vector<double>& stiffnesses) {
  std::vector<std::optional<TuneFailure>> found(stiffnesses.size());
  in_parallel(nullptr, found.size(), [&](std::size_t i) { found[i] = trial_runs_.vibration(setting, stiffnesses[i]); });
  // A run that is not settled needs no second run.
  count_runs(static_cast<std::size_t>(
      std::ranges::count_if(found, [](const auto& failure) { return !failure || failure->binding != "settled"; })));
  return found;
}

std::map<double, TuneFailure> Trials::known_vibrations(const TuneSetting& setting, const Range& stiffnesses) const {
  std::map<double, TuneFailure> found;
  for (const auto& [key, trial] : all_) {
    const auto& [of, K] = key;
    if (of != setting || K < stiffnesses.from || K > stiffnesses.to || !requested_.contains(&trial)) continue;
    if (const auto failure = vibration_of(trial, rules_)) found.emplace(K, *failure);
  }
  return found;
}

/// Runs `count` simulations of a trial on all threads. `trial`: null if the simulations do not count for a search.
void Trials::in_parallel(TuneTrial* trial, std::size_t count, const std::function<void(std::size_t)>& job) {
  count_runs(trial, count);
  for_each_job(count, {question_.threads, ""}, job);
  report_runs();
}

/// Runs holds(0) … holds(count - 1) on all threads until one returns false. Returns the lowest index for which it does,
/// or `count`. Counts the simulations up to this index. An exception of a job counts as a failure, and is rethrown if
/// no lower job fails; the result thus does not depend on the number of threads. `trial`: as for in_parallel().
std::size_t Trials::run_until_failure(TuneTrial* trial, std::size_t count,
                                      const std::function<bool(std::size_t)>& holds) {
  std::atomic<std::size_t> lowest = count;  // lowest job that is known to fail
  std::vector<std::exception_ptr> errors(count);
  for_each_job(count, {question_.threads, ""}, [&](std::size_t i) {
    if (i > lowest) return;
    try {
      if (holds(i)) return;
    } catch (const InputError&) {
      errors[i] = std::current_exception();
    }
    for (std::size_t known = lowest; i < known && !lowest.compare_exchange_weak(known, i);) {
    }
  });
  if (lowest < count && errors[lowest]) std::rethrow_exception(errors[lowest]);
  count_runs(trial, std::min(lowest + 1, count));
  report_runs();
  return lowest;
}

/// Runs one simulation of each trial on all threads.
void Trials::in_parallel(std::span<TuneTrial* const> trials, const std::function<void(std::size_t)>& job) {
  for (TuneTrial* trial : trials) count_runs(trial, 1);
  for_each_job(trials.size(), {question_.threads, ""}, job);
  report_runs();
}

void Trials::count_runs(TuneTrial* trial, std::size_t count) {
  runs_ += count;
  if (trial == nullptr) return;
  trial->runs += count;
  if (requested_.contains(trial)) search_runs_ += count;
}

// ---- Evaluation of the constraints, the cheapest first

/// Evaluates a trial as far as `need` requires, and stores the violated constraint in
/// `trial.binding`; it stays empty if no evaluated constraint is violated.
void Trials::judge(TuneTrial& trial, Need need) {
  trial.binding.clear();
  trial.why.clear();
  trial.too_soft = trial.limits_alone = false;
  if (is_exhausted() && trial.runs == 0 && !trial.failure) {
    trial.fail("runs", fmt::format("the search ended after {} runs", search_runs_));
    return;
  }
  evaluate(trial, need);
  if (trial.failure) {
    trial.fail(trial.failure->binding, trial.failure->why);
    trial.too_soft = trial.failure->too_soft;
    return;
  }
  judge_limits(trial);
  if (!trial.feasible()) return;
  if (const Refutation* refuted = refutation_of(trial)) trial.fail(refuted->constraint, refuted->reason);
}

/// Evaluates the scene without variants: checks the linear loop of permanent springs, judges the motion, and measures
/// the metrics. Stops at the first failure.
void Trials::evaluate_motion(TuneTrial& trial) {
  if (trial.judged == 0 && !trial.failure) {
    if (trial_runs_.has_springs()) trial.failure = trial_runs_.loop_failure(trial, 0, {});
    if (!trial.failure) judge_motion(trial, 0, 1);
  }
  if (!trial.failure) measure_scene(trial);
}

/// Evaluates the trial until a motion fails, or until further runs cannot change the results that `need` requires. A
/// trial far from the limits is not evaluated further than the scene itself, except for Need::all.
void Trials::evaluate(TuneTrial& trial, Need need) {
  constexpr double kNear = 1.5;  // largest excess() at which errors are estimated, so that a search can approach limits
  const auto is_far = [&] { return need != Need::all && excess(trial) > kNear; };
  const auto is_decided = [&] { return need == Need::feasibility && violates_limits(trial); };
  evaluate_motion(trial);
  if (trial.failure || is_far() || is_decided()) return;
  // Evaluate the other variants.
  if (trial.judged < variant_count()) judge_motion(trial, 1, variant_count());
  if (trial.failure) return;
  measure_variants(trial);
  if (question_.limits.empty() || is_far() || is_decided()) return;
  // Estimate the errors. If a limit on a metric other than a depth is violated, a larger K does not help, and
  // Need::softness needs no errors.
  const bool is_stiff = violates_limits(trial) && !violates_only_depths(trial);
  if (need == Need::softness && is_stiff) return;
  refine(trial, Refinement::resolution);
  if (needs_depth(trial, need)) refine(trial, Refinement::depth);
}

/// Returns true if Refinement::depth may change the results that `need` requires. The change of inside_max_m is at most
/// its tolerance (TuneTrial::depth_within). The change of inside_settled_m, a median of a few depths, has no known
/// bound.
bool Trials::needs_depth(const TuneTrial& trial, Need need) const {
  const MetricValues violated = violated_limits(trial);
  if (need <= Need::softness && !violated.empty()) return false;
  for (const auto& [name, bound] : limits_.metrics) {
    const ExtremeValue *max = trial.extreme({name, true}), *min = trial.extreme({name, false});
    if (!depends_on_sampled_depth(name) || max == nullptr || min == nullptr) continue;
    if (name != "inside_max_m") return true;
    const double largest = max->value + trial.depth_within, smallest = min->value - trial.depth_within;
    double factor = 1.0;  // largest possible factor by which the depth is beyond its limit
    if (bound.max && largest > *bound.max) factor = ratio_beyond(largest, *bound.max);
    if (bound.min && smallest < *bound.min) factor = std::max(factor, ratio_beyond(*bound.min, smallest));
    // For Need::excess, the factor of a limit that is already violated matters only if it exceeds the factors of all
    // violated limits.
    const bool counts = need != Need::excess || !violated.contains(name) || factor > excess(trial);
    if (factor > 1.0 && counts) return true;
  }
  return false;
}

/// Stores the motion of a variant in its trial. Keeps an earlier failure.
void Trials::record(TuneTrial& trial, std::size_t variant, const MotionOfVariant& motion) const {
  trial.judged = variant + 1;
  if (variant == 0) {
    trial.lambda_max = motion.at_K.settled.lambda_max;
    trial.contact = motion.contact;
    trial.settled = is_stable(motion.at_K.verdict);
  }
  if (!trial.failure) trial.failure = trial_runs_.motion_failure(trial, variant, motion);
}

/// Runs the variants [first, last) at K and at G K, and records their motions up to the first failing run.
void Trials::judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
  std::vector<MotionOfVariant> motions(last - first);
  const std::size_t failing = run_until_failure(&trial, 2 * motions.size(), [&](std::size_t job) {
    MotionOfVariant& motion = motions[job / 2];
    return job % 2 == 0 ? trial_runs_.is_stable_at_K(trial, first + job / 2, motion)
                        : trial_runs_.is_stable_at_margin(trial, first + job / 2, motion);
  });
  for (std::size_t i = 0; i < motions.size() && 2 * i <= failing; ++i) record(trial, first + i, motions[i]);
}

void Trials::run_ahead(const TuneSetting& setting, std::span<const double> stiffnesses) {
  constexpr std::size_t kRuns = 3;  // largest number of simulations of a trial
  if (search_runs_ + kRuns * stiffnesses.size() > kMaxTuneRuns) return;
  // Each stage runs only trials that have not failed in the stage before.
  std::vector<TuneTrial*> trials;
  for (const double K : stiffnesses) {
    TuneTrial& trial = stored_trial(setting, K);
    if (trial.judged > 0 || trial.failure) continue;
    if (trial_runs_.has_springs()) trial.failure = trial_runs_.loop_failure(trial, 0, {});
    if (!trial.failure) trials.push_back(&trial);
  }
  std::map<const TuneTrial*, MotionOfVariant> motions;
  std::erase_if(trials, [&](const TuneTrial* trial) { return !motions.try_emplace(trial).second; });  // equal K
  in_parallel(trials, [&](std::size_t i) { trial_runs_.is_stable_at_K(*trials[i], 0, motions.at(trials[i])); });
  std::vector<TuneTrial*> settled = trials;
  std::erase_if(settled, [&](const TuneTrial* trial) { return !is_stable(motions.at(trial).at_K.verdict); });
  in_parallel(settled, [&](std::size_t i) { trial_runs_.is_stable_at_margin(*settled[i], 0, motions.at(settled[i])); });
  for (TuneTrial* trial : trials) record(*trial, 0, motions.at(trial));
  std::erase_if(settled, [](const TuneTrial* trial) { return trial->failure.has_value(); });
  in_parallel(settled, [&](std::size_t i) { trial_runs_.measure(*settled[i]); });
}

/// Measures the scene itself unless this was done before.
void Trials::measure_scene(TuneTrial& trial) {
  if (!trial.is_measured) in_parallel(&trial, 1, [&](std::size_t) { trial_runs_.measure(trial); });
}

/// Measures in all variants the metrics for which the user has set limits.
void Trials::measure_variants(TuneTrial& trial) {
  if (trial.is_complete) return;
  trial.is_complete = true;
  if (question_.limits.empty()) return;
  std::vector<MetricValues> metrics(variant_count());
  metrics[0] = trial.metrics;
  in_parallel(&trial, metrics.size() - 1,
              [&](std::size_t i) { metrics[i + 1] = trial_runs_.metrics_in(trial, i + 1); });
  trial_runs_.note_metrics(trial, metrics);
}

/// Raises the error of each metric of the trial (TuneTrial::error) to the change of this metric by a refinement, if the
/// change is larger. A metric that a refined run lacks has no error.
void Trials::refine(TuneTrial& trial, Refinement refinement) {
  bool& is_done = refinement == Refinement::depth ? trial.has_error : trial.is_refined;
  if (is_done) return;
  is_done = true;
  std::size_t runs = 0;
  const MetricValues changes = metric_changes(question_.scenario, trial_runs_.overrides(trial.setting, trial.stiffness),
                                              trial.metrics, refinement, question_.threads, runs);
  for (const auto& [name, change] : changes) {
    const auto known = value_in(trial.error, name);
    if (refinement == Refinement::depth && !known) continue;  // the runs with finer resolution lack this metric
    if (std::isfinite(change))
      trial.error[name] = std::max(change, known.value_or(0.0));
    else
      trial.error.erase(name);
  }
  count_runs(&trial, runs);
  report_runs();
}

/// If the trial violates limits, marks it as infeasible because of the first violated limit. The limits of the user
/// come before the rules of the diagnosis. Precondition: the metrics of the scene were measured.
void Trials::judge_limits(TuneTrial& trial) const {
  const MetricValues violated = violated_limits(trial);
  trial.limits_alone = !violated.empty();
  if (violated.empty()) return;
  auto first = std::ranges::find_if(violated, [this](const auto& entry) { return !is_rule(entry.first); });
  if (first == violated.end()) first = violated.begin();
  const std::string& name = first->first;
  const auto limit = limits_.metrics.find(name);
  const LimitEnd end{name, !violates_end(trial, {name, false})};
  trial.too_soft = limit != limits_.metrics.end() && limit->second.max && end.is_max && violates_only_depths(trial);
  trial.fail(name, violation_text(trial, end));
}

/// Returns the text for the user about a metric that violates one end of its limit. If the limit is a range, the text
/// names the violated end.
std::string Trials::violation_text(const TuneTrial& trial, const LimitEnd& end) const {
  const ExtremeValue* extreme = trial.extreme(end);
  if (extreme == nullptr) return trial.missing.at(end.metric);
  std::string text = extreme->text;
  if (const double error = value_in(trial.error, end.metric).value_or(0.0); error > 0.0)
    text += fmt::format(" +- {:.2g}", error);
  const auto limit = limits_.metrics.find(end.metric);
  if (limit == limits_.metrics.end() || !limit->second.min) return text;
  if (end.is_max) return text + fmt::format(", above the maximum {:g}", *limit->second.max);
  return text + fmt::format(", below the minimum {:g}", *limit->second.min);
}

// ---- Limits on metrics

MetricValues Trials::violated_limits(const TuneTrial& trial) const {
  MetricValues violated;
  for (const auto& [name, bound] : limits_.metrics) {
    const auto largest = trial.kept({name, true}), smallest = trial.kept({name, false});
    double factor = largest && smallest ? 1.0 : kInfinite;
    if (smallest && bound.min && *smallest < *bound.min) factor = ratio_beyond(*bound.min, *smallest);
    if (largest && bound.max && *largest > *bound.max) factor = std::max(factor, ratio_beyond(*largest, *bound.max));
    if (factor > 1.0) violated[name] = factor;
  }
  if (limits_.allow_vibration) return violated;
  for (const auto& [rule, threshold] : rules_) {
    const ExtremeValue* found = trial.extreme({rule, true});
    if (found != nullptr && found->value > threshold) violated[rule] = ratio_beyond(found->value, threshold);
  }
  return violated;
}

bool Trials::violates_end(const TuneTrial& trial, const LimitEnd& end) const {
  const auto limit = limits_.metrics.find(end.metric);
  const auto kept = trial.kept(end);
  if (limit == limits_.metrics.end() || !kept) return false;
  const auto& allowed = end.is_max ? limit->second.max : limit->second.min;
  return allowed && (end.is_max ? *kept > *allowed : *kept < *allowed);
}

bool Trials::violates_only_depths(const TuneTrial& trial) const {
  return std::ranges::all_of(violated_limits(trial), [](const auto& entry) {
    return entry.first.starts_with("inside") || entry.first.starts_with("depth");
  });
}

double Trials::excess(const TuneTrial& trial) const {
  double largest = 1.0;
  for (const auto& [name, times] : violated_limits(trial)) largest = std::max(largest, times);
  return largest;
}

// ---- Verification

const Trials::Refutation* Trials::refutation_of(const TuneTrial& trial) const {
  constexpr double kNearby = 4.0 / 3.0;
  const auto is_near = [](const std::optional<double>& a, const std::optional<double>& b) {
    return a == b || (a && b && *a < kNearby * *b && *b < kNearby * *a);
  };
  const auto applies = [&](const Refutation& refuted) {
    const TuneSetting &a = trial.setting, &b = refuted.setting;
    if (trial.stiffness < refuted.from || trial.stiffness > refuted.to) return false;
    if (exact_refutations_) return a == b;
    return a.filter == b.filter && is_near(a.damping_ratio, b.damping_ratio) && is_near(a.mass, b.mass);
  };
  const auto found = std::ranges::find_if(refutations_, applies);
  return found == refutations_.end() ? nullptr : &*found;
}

void Trials::refute(const TuneSetting& setting, double from, double to, std::string constraint, std::string reason) {
  last_refuted_ = TuneFailure{constraint, reason};
  refutations_.push_back({setting, from, to, std::move(constraint), std::move(reason)});
  for (auto& [key, trial] : all_)
    if (requested_.contains(&trial) && trial.feasible()) judge(trial);
}

bool Trials::restrict_refutations() {
  if (exact_refutations_ || refutations_.empty()) return false;
  exact_refutations_ = true;
  for (auto& [key, trial] : all_)
    if (requested_.contains(&trial)) judge(trial);
  return true;
}

void Trials::note_unstable(double K) {
  smallest_unstable_ = std::min(smallest_unstable_, K);
}

}  // namespace hapbench
