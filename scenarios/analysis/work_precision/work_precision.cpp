#include "scenarios/analysis/work_precision/work_precision.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/analysis/work_precision/pareto_front.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/field_files.hpp"
#include "sim/core/math.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

constexpr const char* kIntegratorPath = "integrator.type";

/// Integrator of the reference solution. All settings of a problem have the same reference solution, so that equal
/// trajectories have equal errors.
const IntegratorEntry& kReferenceIntegrator = kRk4;
/// If a curve has the integrator of the reference solution, this integrator computes a second solution. A setting and a
/// reference solution of one integrator could share an error that their difference does not show.
const IntegratorEntry& kCheckingIntegrator = kVelocityVerlet;

/// A run of the study: a problem with an integrator and a time step.
struct StudyRun {
  std::size_t problem = 0;
  std::string integrator;
  /// Index of the time step. Level 0 is the time step of the scenario; each level divides it by
  /// WorkPrecisionQuestion::ratio once more.
  std::size_t level = 0;
  auto operator<=>(const StudyRun&) const = default;
};

/// Returns the number of levels between the smallest time step of the settings and the time step of the reference
/// solution.
std::size_t reference_levels(double ratio) {
  return static_cast<std::size_t>(std::ceil(math::log(kReferenceRefinement) / math::log(ratio) - 1e-9));
}

/// The problems, curves and levels of a study.
class Study {
 public:
  explicit Study(const WorkPrecisionQuestion& question)
      : question_(question), loaded_(load_scenario(question.scenario, question.overrides)) {
    for (const Axis& axis : question.over) {
      if (axis.path == kStepPath)
        fail_in_option("--over", fmt::format("got {}; allowed: other fields, because --vary refines it. The number of "
                                             "time steps is --levels",
                                             axis.path));
      for (const std::string_view varied : {std::string_view(kIntegratorPath), std::string_view(kStepPath)})
        if (varied.starts_with(axis.path + "."))
          fail_in_option("--over", fmt::format("got {}, which contains {}; allowed: {}", axis.path, varied,
                                               varied == kIntegratorPath ? varied : "other fields"));
      if (axis.path == kIntegratorPath) {
        curves_ = axis.values;
      } else {
        axes_.push_back(axis);
      }
    }
    if (curves_.empty()) curves_ = {std::string(loaded_.scenario.integrator.type->info.name)};
    const Cases problems({question.scenario}, question.overrides, axes_);
    for (std::size_t i = 0; i < problems.size(); ++i) {
      LoadedScenario problem = problems.load(i);
      trials_.push_back(trial_count(problem.scenario.hand));
      // The study runs the first trial, so the noise of other subjects does not matter.
      if (auto* tracking = std::get_if<TrackingHandFields>(&problem.scenario.hand)) tracking->subjects.resize(1);
      levels_.push_back(with_file(problem, [&] {
        return level_sweep(problem, kStepPath, question.levels + reference_levels(question.ratio), question.ratio);
      }));
    }
  }

  std::size_t problems() const { return levels_.size(); }
  const std::vector<std::string>& curves() const { return curves_; }
  /// Returns true if a second integrator checks the reference solution.
  bool checks_reference() const { return std::ranges::count(curves_, kReferenceIntegrator.info.name) > 0; }
  std::size_t finest() const { return question_.levels - 1; }
  std::size_t reference_level() const { return levels_.front().axis.values.size() - 1; }
  /// Returns the time steps of a problem, with the problem's own values of other fields.
  const LevelSweep& levels(std::size_t problem) const { return levels_[problem]; }
  /// Returns the number of trials of a problem, of which the study runs the first.
  double trials(std::size_t problem) const { return trials_[problem]; }

  /// Returns the name of a problem: the values of its axes, or the law if no axis defines problems.
  std::string name(std::size_t problem) const {
    const auto values = Cases({question_.scenario}, {}, axes_).values(problem);
    return values.empty() ? loaded_.scenario.rendering.algorithm : fmt::format("{}", fmt::join(values, ", "));
  }

  /// Loads and checks a run. The overrides of integrator and time step follow the overrides of the problem.
  CheckedScenario load(const StudyRun& run) const {
    std::vector<Axis> axes = axes_;
    axes.push_back({kIntegratorPath, {run.integrator}});
    axes.push_back(levels_[run.problem].axis);
    const Cases cases({question_.scenario}, question_.overrides, std::move(axes));
    return checked(cases.load(run.problem * levels_[run.problem].axis.size() + run.level));
  }

 private:
  const WorkPrecisionQuestion& question_;
  LoadedScenario loaded_;
  std::vector<Axis> axes_;  ///< fields that define problems
  std::vector<std::string> curves_;
  std::vector<LevelSweep> levels_;  ///< time steps of each problem
  std::vector<double> trials_;      ///< number of trials of each problem
};

/// Makes and stores the motions that a study compares with each other. Each motion is made only once.
class Motions {
 public:
  explicit Motions(const Study& study) : study_(study) {
    for (std::size_t problem = 0; problem < study.problems(); ++problem) {
      for (const std::string& curve : study.curves())
        for (std::size_t level = 0; level <= study.finest(); ++level) add({problem, curve, level});
      // Two levels of the reference solution give an estimate of its error.
      for (const std::size_t back : {0u, 1u})
        add({problem, kReferenceIntegrator.info.name, study.reference_level() - back});
      if (study.checks_reference()) add({problem, kCheckingIntegrator.info.name, study.reference_level()});
    }
  }

  /// Loads the run of level 0 of each curve and the runs of the reference level, so that invalid input is found before
  /// the first run. Throws InputError.
  void check() const {
    for (const auto& [run, motion] : motions_)
      if (run.level == 0 || run.level == study_.reference_level()) study_.load(run);
  }

  void run(const JobOptions& jobs) {
    std::vector<std::pair<const StudyRun, SampledMotion>*> all;
    for (auto& entry : motions_) all.push_back(&entry);
    // Start the longest runs first, so that no thread has a long run left at the end.
    std::ranges::stable_sort(all, [](auto* a, auto* b) { return a->first.level > b->first.level; });
    const std::size_t shifts = study_.problems();
    shifted_.resize(shifts);
    for_each_job(all.size() + shifts, jobs, [&](std::size_t job) {
      if (job < all.size()) {
        all[job]->second = sampled_motion(study_.load(all[job]->first));
      } else {
        const std::size_t problem = job - all.size();
        const Vec3 shift = Vec3::Constant(kInitialShift / std::sqrt(3.0));
        shifted_[problem] = sampled_motion(study_.load({problem, study_.curves().front(), study_.finest()}), shift);
      }
    });
  }

  const SampledMotion& at(const StudyRun& run) const { return motions_.at(run); }

  /// Returns the reference solution of a problem.
  const SampledMotion& reference(std::size_t problem) const {
    return at({problem, kReferenceIntegrator.info.name, study_.reference_level()});
  }

  /// Returns the error of the reference solution of a problem: its difference from the next coarser level. If a second
  /// integrator checks the reference solution, and its solution differs more, returns this difference. Returns nothing
  /// if the solutions ended differently.
  std::optional<MotionDifference> reference_error(std::size_t problem) const {
    std::vector<const SampledMotion*> others = {
        &at({problem, kReferenceIntegrator.info.name, study_.reference_level() - 1})};
    if (study_.checks_reference())
      others.push_back(&at({problem, kCheckingIntegrator.info.name, study_.reference_level()}));
    MotionDifference largest;
    for (const SampledMotion* other : others) {
      const auto found = difference(reference(problem), *other);
      if (!found) return std::nullopt;
      largest.position = std::max(largest.position, found->position);
      largest.force = std::max(largest.force, found->force);
    }
    return largest;
  }

  /// Returns the rms distance [m] between two runs that start kInitialShift apart; infinite if they end differently.
  double grown_shift(std::size_t problem) const {
    const auto grown = difference(at({problem, study_.curves().front(), study_.finest()}), shifted_[problem]);
    return grown ? grown->position : std::numeric_limits<double>::infinity();
  }

 private:
  void add(StudyRun run) { motions_.try_emplace(std::move(run)); }

  const Study& study_;
  std::map<StudyRun, SampledMotion> motions_;
  std::vector<SampledMotion> shifted_;  ///< shifted motions, by problem
};

/// Returns the settings of a problem with their errors, without their cost.
std::vector<WorkPrecisionSetting> settings_of(const Study& study, const Motions& motions, std::size_t problem,
                                              bool is_predictable) {
  std::vector<WorkPrecisionSetting> settings;
  // The difference between two runs with different noise is no error.
  const auto reference_error = study.levels(problem).has_noise ? std::nullopt : motions.reference_error(problem);
  for (const std::string& curve : study.curves()) {
    for (std::size_t level = 0; level <= study.finest(); ++level) {
      WorkPrecisionSetting setting{study.name(problem), curve};
      setting.reference_error = reference_error;
      const StudyRun run = {problem, curve, level};
      setting.outcome = motions.at(run).outcome;
      setting.is_expected = outcome_is_expected(study.load(run).scenario().expect, setting.outcome);
      if (reference_error && is_predictable) setting.error = difference(motions.at(run), motions.reference(problem));
      settings.push_back(std::move(setting));
    }
  }
  return settings;
}

std::string reference_text(const Study& study, std::size_t problem) {
  return fmt::format(
      "{} at {} = {}{}{}", kReferenceIntegrator.info.name, kStepPath,
      level_text(study.levels(problem), study.reference_level()),
      study.checks_reference() ? ", checked by " + std::string(kCheckingIntegrator.info.name) : "",
      study.trials(problem) > 1.0 ? fmt::format(", of the first of {:.0f} trials", study.trials(problem)) : "");
}

/// Returns the cheapest setting with an expected outcome whose `error_of` is at most `max_error`; null if no setting
/// has both.
const WorkPrecisionSetting* cheapest(const std::vector<WorkPrecisionSetting>& settings, double max_error,
                                     double (WorkPrecisionSetting::*error_of)() const) {
  const WorkPrecisionSetting* best = nullptr;
  for (const WorkPrecisionSetting& setting : settings) {
    if (!setting.is_expected || !setting.error || (setting.*error_of)() > max_error) continue;
    if (best == nullptr || setting.cost.per_simulated_second() < best->cost.per_simulated_second()) best = &setting;
  }
  return best;
}

}  // namespace

const WorkPrecisionSetting* WorkPrecisionProblem::cheapest_below(double max_error) const {
  return cheapest(settings, max_error, &WorkPrecisionSetting::largest_error);
}

const WorkPrecisionSetting* WorkPrecisionProblem::cheapest_possibly_below(double max_error) const {
  return cheapest(settings, max_error, &WorkPrecisionSetting::smallest_error);
}

void mark_front(std::vector<WorkPrecisionSetting>& settings) {
  std::vector<CostAndError> points;
  std::vector<WorkPrecisionSetting*> compared;
  for (WorkPrecisionSetting& setting : settings) {
    if (!setting.error || !setting.is_expected) continue;
    points.push_back({setting.cost.per_simulated_second(),
                      setting.is_resolved() ? setting.error->position : setting.largest_error()});
    compared.push_back(&setting);
  }
  std::vector<std::size_t> front = pareto_front(points);
  std::erase_if(front, [&](std::size_t i) { return !compared[i]->is_resolved(); });
  for (const std::size_t i : front) compared[i]->on_front = true;
  if (const auto found = knee(points, front)) compared[*found]->is_knee = true;
}

std::vector<WorkPrecisionProblem> work_precision(const WorkPrecisionQuestion& question, const JobOptions& jobs) {
  const Study study(question);
  Motions motions(study);
  motions.check();
  motions.run(jobs);
  // Compute the errors.
  std::vector<WorkPrecisionProblem> problems;
  std::vector<StudyRun> timed;
  for (std::size_t p = 0; p < study.problems(); ++p) {
    WorkPrecisionProblem& problem =
        problems.emplace_back(WorkPrecisionProblem{study.name(p), reference_text(study, p)});
    problem.grown_shift = motions.grown_shift(p);
    problem.noise = study.levels(p).no_order;
    problem.is_predictable = problem.noise.empty() && problem.grown_shift <= question.max_error;
    problem.settings = settings_of(study, motions, p, problem.is_predictable);
    for (const std::string& curve : study.curves())
      for (std::size_t level = 0; level <= study.finest(); ++level) timed.push_back({p, curve, level});
  }
  // Measure the costs when nothing else runs.
  const std::vector<RunCost> costs = measure_cost(
      timed.size(), [&](std::size_t i) { return study.load(timed[i]); }, jobs);
  for (std::size_t i = 0; i < timed.size(); ++i) {
    const std::size_t each = study.curves().size() * question.levels;
    WorkPrecisionSetting& setting = problems[timed[i].problem].settings[i % each];
    setting.cost = costs[i];
    setting.step_s = costs[i].time_step_s;
  }
  for (WorkPrecisionProblem& problem : problems) mark_front(problem.settings);
  return problems;
}

}  // namespace hapbench
