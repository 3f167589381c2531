#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "results/observe/inside.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/observer.hpp"
#include "sim/tool/tool_shape.hpp"

/// Outcomes of runs, whether they were expected, and warnings about runs whose numbers may mislead.
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

/// The length of the way on which a scenario has the tool dragged in `duration` [s]: along a direction as far as the
/// time allows, along points at most to the last one [m].
double way_to_cover(const DragHandFields& hand, double duration);

/// A warning for a path over the surface that falls short of the way `to_cover` [m] by more than the tool's `width`
/// [m]: how long it is and what to change. It is known before the run.
std::optional<Warning> short_path_warning(const DragHandFields& hand, double path, double to_cover, double width);

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
class EncounterObserver : public Observer {
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
  /// After the run: warnings about its outcome.
  virtual std::vector<Warning> warnings(Outcome outcome, const TrialContact& contact) = 0;
  /// The longest way of the tip in a step near the environment; 0 without points [m].
  virtual double longest_step() const = 0;
  /// Null without a solid.
  virtual const InsideObserver* inside() const = 0;
  /// After the run: how deep the tool was, which is looked for at the first call. Null without a solid.
  virtual const InsideDepths* depths() = 0;
};

/// Scenario and parts must outlive the observer; `metrics`, if given, observes before.
std::unique_ptr<EncounterObserver> encounter_observer(const Scenario& scenario, const NamedFiles& files,
                                                      const SimulationParts& parts,
                                                      const MetricsObserver* metrics = nullptr);

/// For a tool whose size is out of proportion with the environment's, a question about scales.
std::optional<Warning> scale_warning(const Scenario& scenario, const ToolShape& tool, const Box& environment);

/// The expectations of the scenario that the run does not meet, one sentence each.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// True when `outcome` is among those the scenario expects.
bool outcome_is_expected(const ExpectFields& expect, Outcome outcome);

/// Warnings about the forces of a run: it passed the limit of explicit friction, or the reduction makes its force jump
/// (results/observe).
std::vector<Warning> force_warnings(const MetricsObserver& metrics);

/// The odd thing about the place of a tool that fills the box in its own frame, as the end of a sentence such as "lies
/// across its axis"; empty when nothing is odd. Tools have their tip centre at the origin, and their tip points along
/// -z.
std::string odd_frame(const Box& tool);

/// Warnings about a tool: a proxy keeps points out of convex tools only, and a mesh may lie oddly in its frame.
std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

}  // namespace hapbench
