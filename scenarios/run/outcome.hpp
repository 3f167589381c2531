#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/observer.hpp"

/// Outcomes of runs, and warnings about them.
namespace hapbench {

/// The longest way of a place in one step near an environment: in one that began no further from the environment's box
/// than it was long, so that it may have met the surface, or passed it.
class StepWay {
 public:
  explicit StepWay(const Box& environment) : environment_(environment) {}

  void add(const Vec3& place) noexcept {
    const double way = (place - place_).norm();
    if (distance_ <= way && std::isfinite(way)) longest_ = std::max(longest_, way);
    place_ = place;
    distance_ = distance_to(environment_, place);
  }
  double longest() const noexcept { return longest_; }    ///< [m]
  double distance() const noexcept { return distance_; }  ///< of the last place from the box; 0 within [m]
  const Box& environment() const noexcept { return environment_; }

 private:
  Box environment_;
  Vec3 place_ = Vec3::Zero();
  double distance_ = std::numeric_limits<double>::infinity(), longest_ = 0.0;
};

/// Notes when the tool touches an open mesh where it ends. Beyond such an edge there is nothing to touch, and a tool
/// that reaches past it is held by too few points or by none.
class OpenEdgeObserver final : public Observer {
 public:
  /// A point of the shell counts as near an edge if it lies within `reach` [m] of one of `edges`, the middles of the
  /// boundary edges, along each coordinate. O(n) and the points near edges.
  OpenEdgeObserver(const PointShell& shell, const std::vector<Vec3>& edges, double reach);

  void on_step(const StepRecord& record) noexcept override;

  /// A warning with the first contact at such a point; nothing when there was none.
  std::optional<Warning> warning() const;

 private:
  double reach_;
  std::vector<bool> is_near_edge_;  ///< of each point of the shell
  std::uint64_t rows_ = 0;          ///< with such a contact
  double first_time_ = 0.0;         ///< [s]
  Vec3 first_place_ = Vec3::Zero();
};

/// Watches a run for all that decides its outcome; some 40 ns a row, no allocation.
class OutcomeObserver : public Observer {
 public:
  /// The outcome of a run with a point shell that ended with `outcome`, which stays unless it is `completes`. That
  /// becomes `went_through` when the tool passed the surface (Passage, CorePassage), by itself or led by a script, or a
  /// part of it was deeper than its half width; `no_contact` when no row had a colliding point; `lost_contact` when a
  /// tool that moves freely ended further from the environment's box than the box is wide and the tool reaches
  /// together, as one does that was thrown out or pushed past, or when a dragged tool had no contact for the default
  /// settling time before the end although the hand pressed; `not_dragged` when one came less than its width along a
  /// way of more than two widths: it was pressed, and its calm numbers tell nothing of a drag; `stuck` when it came to
  /// stand while the target of its hand went on, or a dragged one fell behind in the second half of its way.
  virtual Outcome outcome(Outcome outcome) = 0;
  /// After the run: warnings about its outcome, and about contacts at the edges of an open mesh. Precondition: there
  /// are metrics.
  virtual std::vector<Warning> warnings(Outcome outcome) = 0;
  /// The longest way of the tip in a step near the environment; 0 without points [m].
  virtual double longest_step() const = 0;
  /// Null without a solid.
  virtual const InsideObserver* inside() const = 0;
  /// After the run: how deep the tool was, which is looked for at the first call. Null without a solid.
  virtual const InsideDepths* depths() = 0;
};

/// Scenario and parts must outlive the observer; `metrics` observes before. Without it, what only warnings need is not
/// watched.
std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts,
                                                  const MetricsObserver* metrics = nullptr);

}  // namespace hapbench
