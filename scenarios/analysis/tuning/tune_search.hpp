#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/trials.hpp"

/// The search for the setting with the largest feasible K.
namespace hapbench {

/// Searches the settings of a law for the largest feasible K.
///
/// Tries damping ratios zeta in steps of a factor of 10^(1/4), and the ends of the range of the virtual mass. Where K
/// can be raised by half a percent, raises it to its first limit. If only limits on metrics are violated, walks from
/// the trial that is nearest to keeping them towards them. Then tries filters with the best mass, and refines zeta and
/// mass until a change by 0.4 % does not raise K any more.
class TuneSearch {
 public:
  /// `trials` must outlive this.
  explicit TuneSearch(Trials& trials);

  /// Returns the best trial; empty if nothing is feasible.
  std::optional<TuneTrial> best();
  /// Returns the trial just beyond the best one.
  const TuneTrial& beyond() const { return beyond_; }

 private:
  Range stiffnesses() const;
  bool improve(const TuneSetting& setting);
  std::optional<double> window(const TuneSetting& setting, const SearchWay& way, const TriedParts& scan);
  std::optional<double> feasible_between(const TuneSetting& setting, const SearchWay& way, double soft, double stiff);
  bool is_too_soft(const TuneSetting& setting, const SearchWay& way, double t);
  void refine();
  void approach();
  std::vector<TuneTrial> neighbours(const TuneTrial& trial, double ratio) const;

  Trials& trials_;
  std::vector<TuneSetting> settings_;     ///< to begin with
  std::span<const char* const> filters_;  ///< that are also searched
  std::optional<TuneTrial> best_;
  TuneTrial beyond_;
};

}  // namespace hapbench
