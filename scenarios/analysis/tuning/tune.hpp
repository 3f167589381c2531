#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/analysis/tuning/margins.hpp"
#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"

/// Tunes a force law in a scene: finds the largest K, over damping ratio, velocity filter and virtual mass, at which
/// the worst run of the families is settled with a gain margin and keeps limits on its metrics.
namespace hapbench {

/// The answer for one law.
struct TunedLaw {
  std::string algorithm;
  std::optional<TuneTrial> choice;  ///< none: nothing is feasible
  /// The constraint that a stiffness just beyond the choice violates, or that the nearest trial violates if nothing is
  /// feasible; and the same in words.
  std::string binding, why;
  std::string relax;  ///< where nothing is feasible: which limit to relax, and by how much
  TuneMargins margins;
  FieldLimit edge;  ///< limit of K in the scene as chosen, with its own hand, as `limit` finds it
  /// Largest change of each metric of the own run when the step and the point spacing are halved and depth is evaluated
  /// at every step; none for a metric that such a run does not have.
  TuneMetrics error;
  std::vector<TuneTrial> trials;       ///< all, by setting and K, with trials along K at the choice's setting
  std::size_t runs = 0;                ///< simulations in all
  std::size_t verified = 0;            ///< verification runs between K and G K, all settled (kTriedBetween, kTriedNear)
  std::vector<std::string> overrides;  ///< make the scene the choice
};

/// Tunes one law. The number of threads changes nothing.
///
/// A setting at K is feasible if
/// - the run at K is settled (rule_of) and keeps the limits, for the scene's own run and every member of the families.
///   Without limits of a user, the own run must have low vibration (quiet_numbers in diagnosis.hpp).
/// - the run at G K is settled, for all of them.
/// - the loop in contact has stable eigenvalues up to G K (contact_loops; with hand_family() on an impedance device
/// that a
///   hand holds).
/// The search (tune_search.hpp) finds the feasible setting with the largest K. This choice is then verified
/// (verification.hpp); if it fails, the search continues below it. Throws InputError for a scene without a free
/// position, and Stopped.
TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm);

}  // namespace hapbench
