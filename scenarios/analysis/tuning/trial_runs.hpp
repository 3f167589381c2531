#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/analysis/tuning/scene_variants.hpp"
#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/geometry/point_shell.hpp"

/// The simulations and linear loops of the trials of `tune`.
namespace hapbench {

/// The runs of a variant in a trial. `at_margin` is only used if the run at K is stable.
struct MotionOfVariant {
  RunStability at_K, at_margin;
  ContactOfTrial contact;  ///< contact of the run at K; empty if this run is not stable
};

/// Makes the scenarios of a question for one law, runs them, and evaluates their linear loops. Variants are named by
/// their index; 0 is the scene itself. Several threads may call these functions at the same time; measure() and
/// note_metrics(), which change their trial, only for different trials.
class TrialRuns {
 public:
  /// Builds the surface and the variants. `question` and `algorithm` must outlive this object.
  TrialRuns(const TuneQuestion& question, const std::string& algorithm);

  const TuneRanges& ranges() const { return ranges_; }
  std::size_t variant_count() const { return variants_.size(); }
  /// Returns true if the question includes the variants "hands" (scene_variants()).
  bool over_hands() const { return over_hands_; }
  /// Returns true if the scene renders springs in permanent contact. Their loop is known without a run.
  bool has_springs() const { return springs_lambda_.has_value(); }

  /// Returns the overrides that apply a setting and K [N/m] to the scene.
  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const;
  /// Loads a variant with a setting and K [N/m]. `more`: a further override; empty for none.
  LoadedScenario load(const TuneSetting& setting, double stiffness, std::size_t variant = 0,
                      const std::string& more = {}) const;

  // ---- Linear loops

  /// Returns the linear loops of a scenario in a contact (contact_loops()), with the scenario's stiffness and damping.
  /// For springs in permanent contact, returns the loops along the stiffest direction of the springs. Returns no loops
  /// without contact. `over_hands`: true to include the loops with the hands of typical_hands().
  std::vector<NamedLoop> loops_in_contact(const Scenario& scenario, const ContactOfTrial& contact,
                                          bool over_hands) const;
  /// Returns the failure of a variant whose loop in contact is unstable between K and G K; empty if it is stable.
  std::optional<TuneFailure> loop_failure(const TuneTrial& trial, std::size_t variant,
                                          const ContactOfTrial& contact) const;

  // ---- Motions

  /// Runs a variant at K and stores the result in `motion`. If the run is stable, also linearises its contact. Returns
  /// true if the run is stable.
  bool is_stable_at_K(const TuneTrial& trial, std::size_t variant, MotionOfVariant& motion) const;
  /// Runs a variant at G K and stores the result in `motion`. Returns true if the run is stable.
  bool is_stable_at_margin(const TuneTrial& trial, std::size_t variant, MotionOfVariant& motion) const;
  /// Returns how the motion of a variant fails: a run that is not settled, or an unstable loop in contact; empty if
  /// neither. Precondition: the runs at K and, if that run is stable, at G K were made.
  std::optional<TuneFailure> motion_failure(const TuneTrial& trial, std::size_t variant,
                                            const MotionOfVariant& motion) const;
  /// Runs a variant of a trial with a further override, such as a larger K. Returns the reason if the run is not
  /// settled, or if its loop in contact is unstable between the trial's K and the run's K. Empty if neither.
  std::string failure_of(const TuneTrial& trial, std::size_t variant, const std::string& more) const;
  /// Runs the scene itself in the same way as the command `run`, and returns the findings of its diagnosis.
  std::vector<Diagnosed> findings(const TuneSetting& setting, double stiffness) const;
  /// Runs the scene itself. Returns how it vibrates: its verdict `vibrating` or `diverged` (with the binding
  /// "settled"), or after a second run a violated rule of low vibration. Empty if neither.
  std::optional<TuneFailure> vibration(const TuneSetting& setting, double stiffness) const;

  // ---- Metrics

  /// Measures metrics and low-vibration numbers in the run of the scene itself, and stores them in the trial. A trial
  /// without a rendered force, or with unstable explicit friction, fails.
  void measure(TuneTrial& trial) const;
  /// Runs a variant of a trial and returns its metrics.
  MetricValues metrics_in(const TuneTrial& trial, std::size_t variant) const;
  /// Stores the largest and the smallest value of each limited metric over the variants. `metrics`: metrics of each
  /// variant, from the scene itself on.
  void note_metrics(TuneTrial& trial, std::span<const MetricValues> metrics) const;

 private:
  ContactOfTrial contact_of(const CheckedScenario& scene, const RunStability& run) const;
  std::optional<std::string> unstable_loop(Scenario scenario, const ContactOfTrial& contact, double K, double highest,
                                           bool over_hands) const;
  MetricValues metrics_of(const Result& run) const;

  const TuneQuestion& question_;
  const std::string& algorithm_;
  TuneRanges ranges_;
  bool over_hands_;
  std::vector<SceneVariant> variants_;  ///< the scene itself first
  std::shared_ptr<const PointShell> shell_;
  /// Largest eigenvalue of the stiffness tensor of springs in permanent contact, in units of K; empty otherwise.
  std::optional<double> springs_lambda_;
};

}  // namespace hapbench
