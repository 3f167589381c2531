#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/trials.hpp"

/// Search for the setting with the largest feasible stiffness K.
namespace hapbench {

/// Searches the settings of a law for the largest feasible K.
///
/// Starts from damping ratios zeta in factors of 10^(1/4), with the scene's mass and both ends of the range of the
/// virtual mass. For each setting at which a K 0.5 % above the best K is feasible, searches the largest feasible K.
/// If no trial is feasible but some trials violate only limits on metrics, searches for a feasible trial, by a
/// pattern search that starts at the trial nearest to keeping its limits. Then evaluates velocity filters with the
/// best mass. Finally refines zeta and mass until a change by 0.4 % no longer raises K.
class TuneSearch {
 public:
  /// `trials` must outlive this.
  explicit TuneSearch(Trials& trials);

  /// Returns the feasible trial with the largest K; empty if no trial is feasible.
  std::optional<TuneTrial> best();
  /// Returns the infeasible trial just above the best trial's K. Precondition: best() returned a trial.
  const TuneTrial& beyond() const { return beyond_; }

 private:
  Range stiffnesses() const;
  bool improve(const TuneSetting& setting);
  std::optional<double> window(const TuneSetting& setting, const IntervalSearchOptions& options,
                               const EvaluatedParameters& scan);
  std::optional<double> feasible_between(const TuneSetting& setting, const IntervalSearchOptions& options, double soft,
                                         double stiff);
  bool is_too_soft(const TuneSetting& setting, const IntervalSearchOptions& options, double t);
  void refine();
  void approach();
  std::vector<TuneTrial> neighbours(const TuneTrial& trial, double ratio) const;

  Trials& trials_;
  std::vector<TuneSetting> settings_;     ///< initial settings
  std::span<const char* const> filters_;  ///< velocity filters to search; empty for none
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;
};

}  // namespace hapbench
