#pragma once

#include <memory>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/scene/scenario.hpp"

/// The metrics of runs: those that every run has, and those of the sections of a summary. Observers, summary.json,
/// columns.json, tables of sweeps, `expect` and `describe` follow from the list of sections in metric_sections.cpp.
namespace hapbench {

/// The metrics of a run of the scenario, in the order of the summary, with unit and meaning, without values.
/// `has_reference_force`: the scenario gives a reference force or its stroke has a measured one.
MetricList metrics_without_values(const Scenario& scenario, bool has_reference_force);
/// The metrics of all sections, with so many places in tasks.
MetricList metrics_without_values(std::size_t places);
/// The metrics that `expect` may bound, made once; tasks have two places, as those of the thesis.
const MetricList& all_metrics();

/// The observers of a run for the sections that its scenario asks for.
class SectionObservers {
 public:
  SectionObservers(const Scenario& scenario, bool has_reference_force);

  /// Before each trial.
  void begin(const TrialParts& trial);
  /// In the order of the sections.
  const std::vector<std::unique_ptr<MetricObserver>>& all() const { return observers_; }

  /// The observer of that type; null when the scenario does not ask for it.
  template <class Type>
  Type* find() const {
    for (const auto& observer : observers_) {
      if (auto* found = dynamic_cast<Type*>(observer.get())) return found;
    }
    return nullptr;
  }

  /// Adds the metrics of every run, then the sections with theirs, but of several trials not those that make no sense
  /// over them. `inside`: null without a solid.
  void tell(const MetricsObserver& metrics, const InsideDepths* inside, Result& result) const;

 private:
  std::vector<std::unique_ptr<MetricObserver>> observers_;
  std::vector<std::size_t> kinds_;  ///< place of each observer's section in the list
  std::size_t trials_ = 0;          ///< begun
};

}  // namespace hapbench
