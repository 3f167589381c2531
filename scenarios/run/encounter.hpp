#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "device_model/hands/drag_hand.hpp"
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

/// How close a tool came that touches nothing. A row costs some nanoseconds; the distances from the surface itself are
/// looked up after the run.
class ApproachObserver final : public Observer {
 public:
  /// The shell has points; the run has at most so many steps.
  ApproachObserver(std::shared_ptr<const PointShell> shell, std::uint64_t steps);

  void on_step(const StepRecord& record) noexcept override;

  bool touched() const { return touched_; }        ///< in any row
  const StepWay& steps() const { return steps_; }  ///< of the tip centre
  /// Of the tip centre to the environment's box before the first contact; 0 within it [m].
  double closest_to_box() const;

  struct Closest {
    double distance, time;  ///< of the tool from the nearest point [m], and when [s]
  };
  /// In up to 256 rows before the first contact, of as many parts of the run those closest to the environment's box;
  /// within a hundredth of the distance in these.
  Closest closest_to_surface(const ToolShape& tool) const;

 private:
  static constexpr std::size_t kLooks = 256;
  struct Look {
    double time, from_box;
    ToolPose pose;
  };
  std::shared_ptr<const PointShell> shell_;
  StepWay steps_;
  std::uint64_t every_;
  std::vector<Look> looks_;
  bool touched_ = false;
};

/// The length of the way on which a scenario has the tool dragged in `duration` [s]: along a direction as far as the
/// time allows, along points at most to the last one [m].
double way_to_cover(const DragHandFields& hand, double duration);

/// A warning for a path over the surface that falls short of the way `to_cover` [m] by more than the tool's `width`
/// [m]: how long it is and what to change. It is known before the run.
std::optional<Warning> short_path_warning(const DragHandFields& hand, double path, double to_cover, double width);

/// A tool that stood still to the end while the target of its hand went on.
struct Stuck {
  double since = 0.0;                  ///< [s]
  double way = 0.0, target_way = 0.0;  ///< of tool and target from then on [m]
  Vec3 place = Vec3::Zero();           ///< of the tip, in the last row [m]
  double force = 0.0;                  ///< size of the rendered force in the last row [N]
};

/// Follows a dragged tool on the path along which it is led; a look-up in the path's table, no allocation.
class DragCourseObserver final : public Observer {
 public:
  /// The hand and its fields must outlive the observer. `half_width`: the tool's [m].
  DragCourseObserver(const DragHand& hand, const DragHandFields& fields, double half_width)
      : hand_(hand), fields_(fields), width_(2.0 * half_width) {}

  void on_step(const StepRecord& record) noexcept override;

  /// Time of the last contact, if the tool had no contact for the default settling time before the end although the
  /// hand pressed: after that long the next touch would be a landing.
  std::optional<double> lost() const;
  /// True when the tool came less than its width along a way of more than two widths: the spring that leads it lags by
  /// less.
  bool not_dragged() const;
  /// Warnings that the tool lost the surface, and of a path that ends early.
  std::vector<Warning> warnings(Outcome outcome) const;

 private:
  const DragHand& hand_;
  const DragHandFields& fields_;
  double width_;              ///< the tool's [m]
  double way_ = 0.0;          ///< furthest that the tool came on the path [m]
  double time_ = 0.0;         ///< of the last row
  Vec3 place_ = Vec3::Zero();  ///< of the tip in the last row [m]
  std::optional<double> last_contact_;
};

/// Finds a tool that a hand's spring cannot move, that of a subject at a display, too: its target is the intended
/// position; that of a hand that drags is the point that leads the tool. A spring whose target goes into the surface
/// presses the tool on it, which is no sticking: so the tool is stuck only where the target came away from it by more
/// than its width across the direction in which the springs of the contacts push. No allocation; about 30 ns a row.
class StuckObserver final : public Observer {
 public:
  /// `target`: of the spring, at the time of the row that was the last [s]. `width`: the tool's [m].
  StuckObserver(std::function<Vec3(double)> target, double width) : target_(std::move(target)), width_(width) {}

  void on_step(const StepRecord& record) noexcept override;

  /// None where the tool moves in the end, or its target does not.
  std::optional<Stuck> stuck() const;

 private:
  std::function<Vec3(double)> target_;
  double width_;
  Vec3 push_ = Vec3::Zero();  ///< spring force, its mean over the last rows [N]
  Box ways_, target_ways_;    ///< around the places of tool and target since it stands
  double across_ = 0.0;       ///< furthest that the target was from the tool across the push since then [m]
  bool began_ = false;
  Stuck stuck_;
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

/// Watches a run with a point shell for all that decides its outcome.
class EncounterObserver final : public Observer {
 public:
  /// Scenario and parts must outlive it; `metrics`, if given, observes before.
  EncounterObserver(const Scenario& scenario, const NamedFiles& files, const SimulationParts& parts,
                    const MetricsObserver* metrics = nullptr);

  void on_step(const StepRecord& record) noexcept override;

  /// Null without a solid.
  const InsideObserver* inside() const { return inside_ ? &*inside_ : nullptr; }

  /// The outcome of a run that ended with `outcome`, which stays unless it is `completes`. That becomes `went_through`
  /// when the tool passed the surface (Passage), by itself or led by a script, or a part of it was deeper than its half
  /// width; `no_contact` when no row had a colliding point; `lost_contact` when a tool that moves freely ended further
  /// from the environment's box than the box is wide and the tool reaches together, as one does that was thrown out or
  /// pushed past, or when a dragged tool lost the surface; `not_dragged` when one came nowhere (DragCourseObserver): it
  /// was pressed, and its calm numbers tell nothing of a drag; `stuck` when it came to stand while the target of its
  /// hand went on.
  Outcome outcome(Outcome outcome);
  /// After the run: warnings about its outcome.
  std::vector<Warning> warnings(Outcome outcome, const TrialContact& contact);
  /// The longest way of the tip in a step near the environment; 0 without points [m].
  double longest_step() const { return approach_ ? approach_->steps().longest() : 0.0; }
  /// After the run: how deep the tool was, which is looked for at the first call. Null without a solid.
  const InsideDepths* depths();

 private:
  /// What happened and what the likely cause is; none for other outcomes, and none for a dragged tool that lost the
  /// surface within the environment's box.
  std::optional<Warning> warning_about(Outcome outcome, const TrialContact& contact);
  /// A likely cause, or where to look when none suggests itself: its kind, and the end of a sentence.
  std::pair<const char*, std::string> likely_cause(Outcome outcome, const TrialContact& contact) const;
  /// How deep any part of the tool was in any row; 0 without a solid [m].
  double inside_max();

  const Scenario& scenario_;
  std::shared_ptr<const ToolShape> tool_;
  std::optional<InsideObserver> inside_;
  std::optional<InsideDepths> depths_;
  std::optional<ApproachObserver> approach_;
  std::optional<DragCourseObserver> drag_;
  std::optional<StuckObserver> stuck_;
};

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
