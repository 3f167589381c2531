#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/analysis/tuning/margins.hpp"
#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"

/// Tunes a force law in a scene. Varies damping ratio, velocity filter and virtual mass, and finds the setting that
/// allows the largest K. At this K, all variants of the scene keep the limits on their metrics and are settled with a
/// gain margin.
namespace hapbench {

/// The result for one law.
struct TunedLaw {
  std::string algorithm;
  std::optional<TuneTrial> choice;  ///< the best feasible setting and its K; empty if no setting is feasible
  /// Constraint (TuneTrial::binding) that a slightly larger K violates. Without a choice, the violated constraint that
  /// explain() selects.
  std::string binding;
  std::string why;    ///< reason of the violation, for the user
  std::string relax;  ///< without a choice: which limit to relax, and by how much; or which option to change
  TuneMargins margins;
  FieldLimit limits;  ///< stability limits of K in the scene with the choice and the scene's hand
  /// Error estimates: largest change of each metric of the scene's run if the time step is halved, the point spacing is
  /// halved, or depth is evaluated at every step. A metric that one of these runs lacks has no entry.
  MetricValues error;
  std::vector<TuneTrial> trials;  ///< all trials, by setting and K
  std::size_t runs = 0;           ///< total number of simulations
  /// Findings of the diagnosis that `run` prints for the scene with the choice (diagnosis_findings()). No finding is a
  /// failure, and none is a vibration unless TuneQuestion::allow_vibration is true.
  std::vector<Diagnosed> findings;
  std::size_t verified = 0;            ///< number of verification runs between K and G K, all of them settled
  std::vector<std::string> overrides;  ///< overrides that apply the choice to the scene
};

/// Tunes one law. The result does not depend on the number of threads. G: TuneQuestion::margin.
///
/// A setting at K is feasible if
/// - every variant of the scene, including the scene itself, is settled at K, that is, stable by rule_of(). Its
///   metrics keep the limits even with their errors added.
/// - the run of the scene itself has low vibration (Diagnose::low_vibration in run_scenario.hpp). This condition is
///   dropped if TuneQuestion::allow_vibration is true.
/// - the run of the scene itself renders a force, and explicit integration of friction is stable in all its steps.
/// - every variant is settled at G K.
/// - the loop in contact has stable eigenvalues from K to G K (contact_loops(); with every hand of
///   typical_hands() if a hand holds an impedance device).
///
/// The search (tune_search.hpp) finds the feasible setting with the largest K. This choice is then verified
/// (verification.hpp), with low vibration also at stiffnesses slightly below K. If the verification fails, the search
/// is repeated without this choice. If nothing is feasible, searches with relaxed limits confirm the relaxations that
/// TunedLaw::relax names (relaxation.hpp). If one of these searches finds a trial that keeps all original limits, this
/// trial becomes the choice. Throws InputError if the tool's position is prescribed, and Stopped.
TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm);

}  // namespace hapbench
