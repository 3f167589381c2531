#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"

/// Defines the metrics of a run: metrics that every run has, and metrics of optional sections, such as friction. The
/// list of sections in metric_sections.cpp determines the observers, summary.json, columns.json, the columns of sweeps,
/// and the metrics in `expect` and `describe`.
namespace hapbench {

/// Returns the metrics of a run of the scenario with name, unit and meaning but without values, in the order of
/// the summary. `has_reference_force` is true if the scenario has a reference force or its recorded stroke has a
/// measured force.
MetricList metrics_without_values(const Scenario& scenario, bool has_reference_force);
/// As above. Whether a recorded stroke has a measured force is read from its file. Throws InputError if the file cannot
/// be used.
MetricList metrics_without_values(const LoadedScenario& loaded);
/// Returns the metrics of all sections, without values. `target_positions` is the number of target positions of a
/// tracking task.
MetricList metrics_without_values(std::size_t target_positions);
/// Returns the metrics that `expect` can bound. The list is computed once. It has metrics for two target
/// positions, because the tasks of the thesis have two.
const MetricList& all_metrics();
/// Returns the condition under which runs have a metric, such as "with record.energy, in a run of a single trial".
/// Empty if every run has it.
std::string condition_of_metric(std::string_view metric);

/// The observers of a run: one observer for each section that the scenario requests.
class SectionObservers {
 public:
  SectionObservers(const Scenario& scenario, bool has_reference_force);

  /// Notifies all observers that a trial begins. Called before each trial.
  void begin(const TrialParts& trial);
  /// Returns the observers in the order of the sections.
  const std::vector<std::unique_ptr<MetricObserver>>& all() const { return observers_; }

  /// Returns the observer of type Type, or null if the scenario does not request its section.
  template <class Type>
  Type* find() const {
    for (const auto& observer : observers_) {
      if (auto* found = dynamic_cast<Type*>(observer.get())) return found;
    }
    return nullptr;
  }

  /// Adds to `result` the metrics that every run has, then the metrics of each section. After several trials,
  /// sections that cannot be computed over several trials are skipped. `inside` is null if the environment has no
  /// solid.
  void report(const MetricsObserver& metrics, const InsideDepths* inside, Result& result) const;

 private:
  std::vector<std::unique_ptr<MetricObserver>> observers_;
  std::vector<std::size_t> kinds_;  ///< for each observer: index of its section in the list of sections
  std::size_t trials_ = 0;          ///< number of trials that have begun
};

}  // namespace hapbench
