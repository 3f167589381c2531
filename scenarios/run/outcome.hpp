#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/loop/simulation.hpp"

/// Classifies how a run ended (its outcome), and explains the outcome in warnings.
namespace hapbench {

/// Facts about a trial that explain its outcome, and decide which advice is right.
struct OutcomeFacts {
  bool began_inside = false;   ///< the tip centre was inside the environment's solid in the first step
  std::string scale_question;  ///< question about a size that is probably wrong (scale_question()); usually empty
  /// Dry friction of the impedance device [N per axis], if this friction holds the handle at the end of the trial
  /// because the force of the hand is smaller. Empty if friction does not hold the handle, or if the tool touched the
  /// surface in the trial.
  std::optional<double> holding_friction;
};

/// Selects whether a run ends before its last step if it has failed.
enum class RunLength {
  /// All steps are made.
  full,
  /// For batches of runs: a run ends at its first final failure (FinalFailure). This requires that the position of the
  /// tool is free, the hand is not of type tracking, the scenario has no stop condition, and the scenario expects none
  /// of the outcomes that are possible after this failure. The outcome is the outcome of the full run in any case.
  until_failure
};

/// A failure that no later step can undo.
/// - went_through: the tip centre is deeper than the tool's half width, or the core of the tool has passed through the
///   surface (Passage::deep and left, CorePassage::event). The outcome of the full run is then went_through, or
///   diverges if a later step exceeds a bound of the scenario.
/// - lost_contact, or no_contact if the tool never touched the environment: a freely moving tool is further from the
///   environment's bounding box than the sum of the box's diagonal and the tool's extent, does not move towards the
///   box, and has no rendered force. The device is ideal, and there is no hand, or a hand of type force or push with a
///   constant force that does not pull the tool back. Otherwise the tool may come back, and only the end of the run
///   determines the outcome.
struct FinalFailure {
  Outcome outcome;
  double time;         ///< [s]
  std::uint64_t step;  ///< number of the step
};

/// Observes all quantities of a trial that determine its outcome. Cost: about 40 ns a step, no allocation.
class OutcomeObserver : public Observer {
 public:
  /// Returns the final failure of the trial; empty if there is none so far, and always empty with RunLength::full.
  /// After a final failure, the observer ignores all further steps.
  virtual const std::optional<FinalFailure>& final_failure() const noexcept = 0;
  /// Returns true if the tool has passed through the surface: the condition of FinalFailure for went_through, with
  /// either RunLength.
  virtual bool has_passed() const noexcept = 0;
  /// Returns the outcome of a run whose simulation ended with `ending`. For a completed run with a point shell,
  /// this is the first outcome whose condition holds (kConditions in outcome.cpp; outcome_infos() describes the
  /// conditions).
  virtual Outcome outcome(Ending ending) = 0;
  /// Returns warnings that explain the outcome, and a warning if the path of a drag was too short. Called after
  /// the run. Precondition: the observer was created with `metrics`.
  virtual std::vector<Warning> warnings(Outcome outcome) = 0;
  /// Returns the longest displacement of the tip in a single step near the surface [m]. Counts only steps whose length
  /// is at least the distance from the environment's bounding box at the start of the step: such a step may have
  /// reached the surface or jumped over it. 0 without a point shell.
  virtual double longest_step() const = 0;
  /// Returns the facts that explain the outcome. Called after the run; default facts without a point shell.
  virtual OutcomeFacts facts() const = 0;
  /// Observer of the tool's depth inside the environment's solid; null if the environment has no solid.
  virtual const InsideObserver* inside() const = 0;
  /// Returns the depths of the tool inside the solid. Called after the run; the first call computes them. Null
  /// if the environment has no solid.
  virtual const InsideDepths* depths() = 0;
};

/// Creates the observer of a trial. `scenario` and `parts` must outlive the observer. `metrics`: observer that must be
/// notified of each step before the created observer; null if warnings() is never called. `length`: determines whether
/// the created observer detects a final failure.
std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts,
                                                  const MetricsObserver* metrics = nullptr,
                                                  RunLength length = RunLength::full);

}  // namespace hapbench
