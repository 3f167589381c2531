#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "results/observe/force_fidelity.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/loop/observer.hpp"
#include "sim/loop/simulation.hpp"

/// The sections of a summary that not every run has: energy, targets and others. The list in metric_sections.cpp is the
/// one place that says which there are; observers, summary.json, columns.json, tables of sweeps, `expect` and
/// `describe` follow from it.
namespace hapbench {

/// The sections that a run has: name -> number of target places, 1 for sections without places.
using SectionParts = std::map<std::string, std::size_t, std::less<>>;

/// The sections of a run of the scenario. `has_reference_force`: the scenario gives a reference force or its stroke has
/// a measured one.
SectionParts sections_of(const Scenario& scenario, bool has_reference_force);
/// Adds the sections that another run has.
void add_sections(SectionParts& sections, const SectionParts& more);

/// The metrics of runs with these sections, in the order of the summary, with unit and meaning, without values.
MetricList metrics_without_values(const SectionParts& sections);
/// The metrics of all sections: those that `expect` may bound. Tasks have two places, as those of the thesis.
std::vector<std::string> metric_names();
/// The same with unit and meaning, without values.
MetricList metrics_without_values(std::size_t places = 2);

/// The inputs from which the observers of a trial are made.
struct TrialParts {
  const Scenario& scenario;
  const SimulationParts& simulation;
  std::shared_ptr<const ReferenceForce> reference;  ///< null without
  std::size_t subject = 0, trial = 0;
};

/// The observers of a trial for the sections that its scenario asks for.
class SectionObservers {
 public:
  explicit SectionObservers(const TrialParts& parts);

  /// In the order of the sections.
  const std::vector<std::unique_ptr<Observer>>& all() const { return observers_; }

  /// The observer of that type; null when the scenario does not ask for it.
  template <class Type>
  Type* find() const {
    for (const auto& observer : observers_) {
      if (auto* found = dynamic_cast<Type*>(observer.get())) return found;
    }
    return nullptr;
  }

  /// The sections of a run of these trials of one scenario. Several trials have only the sections that can be merged.
  static std::vector<MetricSection> summarised(std::span<const SectionObservers* const> trials);

 private:
  std::shared_ptr<const ReferenceForce> reference_;
  std::vector<std::unique_ptr<Observer>> observers_;
  std::vector<std::size_t> kinds_;  ///< place of each observer's section in the list
};

}  // namespace hapbench
