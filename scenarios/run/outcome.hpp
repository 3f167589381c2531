#pragma once

#include <memory>
#include <vector>

#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/loop/simulation.hpp"

/// Outcomes of runs, and warnings about them.
namespace hapbench {

/// Watches a trial for all that decides its outcome; some 40 ns a row, no allocation.
class OutcomeObserver : public Observer {
 public:
  /// The outcome of a run whose stepping ended with `ending`. A run with a point shell that has completed gets the
  /// first outcome whose condition holds (kConditions in outcome.cpp; outcome_infos() has the same in words).
  virtual Outcome outcome(Ending ending) = 0;
  /// After the run: warnings about its outcome and the path of a drag. Precondition: there are metrics.
  virtual std::vector<Warning> warnings(Outcome outcome) = 0;
  /// The longest way of the tip in one step that began no further from the environment's box than it was long, so that
  /// it may have met the surface, or passed it; 0 without points [m].
  virtual double longest_step() const = 0;
  /// Null without a solid.
  virtual const InsideObserver* inside() const = 0;
  /// After the run: how deep the tool was, which is looked for at the first call. Null without a solid.
  virtual const InsideDepths* depths() = 0;
};

/// Scenario and parts must outlive it; `metrics` observes before, and may be null where nobody asks for warnings.
std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts,
                                                  const MetricsObserver* metrics = nullptr);

}  // namespace hapbench
