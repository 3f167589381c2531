#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/trials.hpp"

/// Search for the setting with the largest feasible stiffness K.
namespace hapbench {

/// Returns a value of one end of a limit that is stricter by a factor > 1: smaller for a maximum, larger for a minimum.
double stricter(double value, const LimitEnd& end, double factor);

/// Searches the settings of a law for the largest feasible K.
///
/// The initial settings combine damping ratios zeta, spaced by factors of about 10^(1/4), with up to three virtual
/// masses: the scene's mass and both ends of the mass range. The search has four stages:
/// - For each initial setting, it first evaluates a K that is 0.5 % above the best K so far. If the setting is feasible
///   there, it scans larger K in kScanIntervals intervals, and bisects above the highest two neighbouring feasible
///   values of the scan, or above the first feasible value if no two neighbours are feasible.
/// - Only if no trial is feasible, it divides intervals of the scan into thirds if the run of the scene itself is
///   settled at one of their ends. It then evaluates the velocity filters. Finally, it reduces excess() by pattern
///   searches from the trials with the smallest excess().
/// - It evaluates the velocity filters with the best mass.
/// - It refines zeta and mass until a change by 0.4 % no longer raises K.
class TuneSearch {
 public:
  /// `trials` must outlive this object.
  explicit TuneSearch(Trials& trials);

  /// Returns the feasible trial with the largest K that the search finds; empty if it finds none.
  std::optional<TuneTrial> best();
  /// Returns a feasible trial that keeps a strict value of one end of a limit (TuneTrial::kept()). From the feasible
  /// trial with the strictest value, a pattern search goes to neighbours with a value stricter by at least 0.5 %. Empty
  /// under the same condition as best(). Precondition: the current limits have the metric of `end`.
  std::optional<TuneTrial> strictest(const LimitEnd& end);
  /// Returns the infeasible trial just above the best trial's K. If the best trial is at the end of the search range,
  /// returns a trial that has only the binding "range". Precondition: best() returned a trial.
  const TuneTrial& beyond() const { return beyond_; }

 private:
  Range stiffnesses() const;
  bool improve(const TuneSetting& setting);
  std::optional<double> window(const TuneSetting& setting, const IntervalSearchOptions& options,
                               const EvaluatedParameters& scan);
  std::optional<double> feasible_between(const TuneSetting& setting, const IntervalSearchOptions& options, double soft,
                                         double stiff);
  void add_known(const TuneSetting& setting, const IntervalSearchOptions& options, EvaluatedParameters& scan) const;
  bool is_too_soft(const TuneSetting& setting, const IntervalSearchOptions& options, double t);
  void search_settings();
  void continue_from(const TuneTrial& trial);
  void scan_finely(const TuneSetting& setting);
  void refine();
  void approach(const TuneTrial& start);
  TuneTrial require_stricter(const TuneTrial& trial, const LimitEnd& end);
  std::vector<TuneTrial> neighbours(const TuneTrial& trial, double ratio) const;

  Trials& trials_;
  std::vector<TuneSetting> settings_;     ///< initial settings
  std::span<const char* const> filters_;  ///< velocity filters to search; empty for none
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;
};

}  // namespace hapbench
