#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/contact/inside.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

class MetricsObserver;

/// Depths of the tool in the environment, in one or several trials.
struct InsideDepths {
  /// Largest depth of any point of the tool in the searched steps [m]: in any step, or with a search during the run in
  /// the recorded steps.
  std::optional<double> max;
  /// Largest depth that the search for the deepest step after the run found [m]. `max` can be larger, because it also
  /// contains depths that were searched for `settled` or during the run. It can be smaller if the run records only some
  /// steps. The outcome of a run uses this depth, so that it does not depend on what the run records and measures.
  std::optional<double> searched;
  std::vector<double> settled;  ///< depths of the tool in some steps in settled contact [m]
  /// Bounds on the search error [m]: `max` may be too small by up to max_within + InsideSearch::kTolerance * max, and
  /// each value of `settled` by up to settled_within + InsideSearch::kTolerance times the value.
  double max_within = 0.0, settled_within = 0.0;
  std::uint64_t rows = 0;           ///< steps in which it is known whether the tip centre is inside or outside
  std::uint64_t centre_inside = 0;  ///< steps with the tip centre inside

  std::optional<double> settled_median() const;
  /// Upper bound of the depth in the searched steps [m]. The search has a relative tolerance, so the true depth may
  /// exceed `max` by this fraction.
  double max_bound() const { return (1.0 + InsideSearch::kTolerance) * max.value_or(0.0); }
  /// Merges the depths of another trial into this object.
  void add(const InsideDepths& trial);
  /// Reports the metrics. `has_settled`: true if settled contact was long enough for the metrics of settled contact
  /// (kMinSettledTime).
  void report(Section& section, bool has_settled) const;
};

/// Passage of the tool through the surface in a run, detected by two points: the tip centre, and the front point of
/// the core (the part of the tool's axis within the body). The front point is half the tool's width away from the
/// surface of the tip: for a ball it is the tip centre, for a flat tip it lies half the width behind the tip centre.
/// CorePassage detects passages of the rest of the core.
struct Passage {
  struct Event {
    double time;  ///< [s]
    Vec3 point;   ///< [m]
  };
  std::optional<Event> deep;  ///< first step with the tip centre deeper than half the tool's width
  /// deepest: largest depth of the tip centre over all steps, with a relative error of at most 2 % [m]. last_depth:
  /// depth of the tip centre in the last step [m].
  double deepest = 0.0, last_depth = 0.0;
  /// began_inside: true if the front point was inside in the first step. ends_inside: true if it was inside in the last
  /// step.
  bool began_inside = false, ends_inside = false;
  /// First step in which the front point left the solid on another side than it had entered: the surface normals at
  /// entry and exit differ by more than 90 degrees. `entered` is the position of the entry.
  std::optional<Event> left;
  Vec3 entered = Vec3::Zero();  ///< [m]

  bool went_through() const noexcept { return deep || left || ends_inside; }
};

/// Returns the distance along the axis from the tip centre to the front point of the core (struct Passage) [m]; 0 for a
/// ball.
double core_offset(const ToolShape& tool);

/// Side of the surface on which a point lies; unknown beyond the border of an open surface.
enum class SolidSide { unknown, outside, inside };

/// Detects a tool that passes through a wall, also a wall thinner than the tool. Follows the core: the part of the
/// tool's axis within the body, from the tip centre to the far end. While no contact is deep, the core of a flat tip
/// begins 0.9 half widths behind the tip centre, because the tip centre lies inside the solid even in a shallow
/// contact. The core has passed if it crosses the solid from face to face at one time, with faces of opposed normals,
/// or if a part of it leaves by a face opposed to the face by which it entered. A check evaluates about 20 distances
/// along the axis. A step is checked only if three conditions hold: no passage has been found yet; a contact is deeper
/// than check_depth_ or the tool moved by more than check_displacement_; and the core has moved by at least its
/// distance from the surface. Allocates only in the constructor.
class CorePassage {
 public:
  struct Event {
    double time;         ///< [s]
    Vec3 entered, left;  ///< [m]
    bool at_once;        ///< true if the core crossed from face to face at one time
  };

  CorePassage(const ToolShape& tool, std::shared_ptr<const Solid> solid);

  /// Adds a step. `deepest_contact`: depth of the deepest contact in this step [m]. `moved`: distance that the front
  /// point of the core (struct Passage) has moved since the previous step [m].
  void add(const ToolPose& pose, double deepest_contact, double moved, double time) noexcept {
    if (event_) return;
    if (deepest_contact >= check_depth_ || moved > check_displacement_) {
      check_core(pose, deepest_contact, time);
    } else {
      free_distance_ = 0.0;
      continues_ = false;
    }
    position_ = pose.position;
    axis_ = pose.axis;
    began_ = true;
  }

  const std::optional<Event>& event() const noexcept { return event_; }

 private:
  /// A segment of the core that is inside the solid: the part of the axis from `low` to `high` [m].
  struct Segment {
    double low, high;
    std::optional<Vec3> face_low, face_high;  ///< outward normals at the ends that lie at the surface
    double deepest;                           ///< smallest signed distance phi [m], negative inside
    Vec3 deepest_position;
    /// Normal of the face by which the segment entered, position of the entry, and the interval of the axis [m] that
    /// entered at this position.
    Vec3 normal = Vec3::Zero(), entered = Vec3::Zero();
    double entered_low = 0.0, entered_high = 0.0;
    bool continued = false;  ///< true if a segment of the next check overlaps this segment
  };

  /// A point of the axis whose distance was evaluated: its coordinate on the axis [m], and the distance.
  struct AxisPoint {
    double s;
    KnownDistance distance;
    bool known;
  };
  SurfaceDistance distance_at(const Vec3& point, double s) noexcept;
  void check_core(const ToolPose& pose, double deepest_contact, double time) noexcept;
  double find_segments(const Vec3& position, const Vec3& axis, double front) noexcept;
  const Segment* continued_by(const Segment& next) noexcept;
  void compare(const Vec3& position, const Vec3& axis, double time) noexcept;
  Vec3 normal_at(const Vec3& point) const noexcept;

  std::shared_ptr<const Solid> solid_;
  double width_;          ///< half width of the tool [m]
  double far_end_;        ///< coordinate on the axis of the end of the core that is farthest from the tip [m]
  double shallow_start_;  ///< coordinate at which the core begins while no contact is deep [m]
  /// A step may be skipped if its contacts are shallower than check_depth_ [m] and the tool moved by at most
  /// check_displacement_ [m].
  double check_depth_, check_displacement_;

  Vec3 position_ = Vec3::Zero(), axis_ = Vec3::Zero();  ///< tip centre and axis in the previous step
  /// began_: true if there was a previous step. continues_: true if the previous step was not skipped.
  bool began_ = false, continues_ = false;
  double free_distance_ = 0.0;  ///< distance that the core can move without meeting the surface [m]
  /// segments_: segments of this check. last_segments_: segments of the last check.
  std::vector<Segment> segments_, last_segments_;
  /// axis_points_ and last_axis_points_: evaluated points of this check and of the last check, starting at the tip.
  /// next_axis_point_: index of the point in last_axis_points_ that is nearest to the current point.
  std::vector<AxisPoint> axis_points_, last_axis_points_;
  std::size_t next_axis_point_ = 0;
  std::optional<Event> event_;
};

/// Keeps a fixed number of poses of a run. The run is divided into blocks of equally many steps. Each block keeps the
/// pose with the largest key. The key is a number that the caller gives, such as a depth. Each block also keeps an
/// upper bound of the motion of the tool between the kept pose and any other pose of the block.
class PoseSamples {
 public:
  struct Sample {
    ToolPose pose;
    double key;
    /// Upper bound of the distance of any point of the tool between this pose and the block's other poses [m].
    double max_motion = 0.0;
  };
  /// Precondition: `max_samples` is even, and the tool outlives this object.
  PoseSamples(std::size_t max_samples, const ToolShape& tool) : max_samples_(max_samples), tool_(tool) {
    samples_.reserve(max_samples);
  }
  void add(const ToolPose& pose, double key) noexcept {
    if (rows_left_ == 0) return begin_block(pose, key);
    --rows_left_;
    Sample& block = samples_.back();
    const double moved = tool_.displacement_bound(block.pose, pose);
    if (key > block.key) {
      block = {pose, key, block.max_motion + moved};
    } else if (moved > block.max_motion) {
      block.max_motion = moved;
    }
  }
  const std::vector<Sample>& all() const noexcept { return samples_; }

 private:
  std::size_t max_samples_;
  const ToolShape& tool_;
  Sample joined(const Sample& a, const Sample& b) const noexcept;
  void begin_block(const ToolPose& pose, double key) noexcept;

  std::vector<Sample> samples_;
  /// rows_left_: number of steps that the last block still lacks. rows_of_block_: number of steps of a full block.
  std::uint64_t rows_left_ = 0, rows_of_block_ = 1;
};

/// Observes how deep the tool is in the environment in one trial. A step costs about ten nanoseconds: a point cannot
/// pass the surface before it has moved by its distance from the surface, so few steps need a check. The deepest
/// point of the tool is searched after the run: in the steps with the deepest contact or tip centre, in the steps
/// that may be deeper (InsideBound), and in some steps in settled contact. With `every` > 0, the deepest point is
/// searched during the run as well, in each `every`-th step, also for the depths in settled contact. Does not allocate
/// during the run.
class InsideObserver final : public Observer {
 public:
  /// `metrics`: if not null, must observe before this observer; it determines which steps are in settled contact.
  /// `every`: see the class; 0: no search during the run. `steps`: number of steps of the run.
  InsideObserver(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid,
                 const MetricsObserver* metrics = nullptr, std::uint64_t every = 0, std::uint64_t steps = 0);

  void on_step(const StepRecord& record) noexcept override;

  /// Depth of the tool in the last step [m]; empty if unknown, and in steps without a search.
  const std::optional<double>& depth() const noexcept { return depth_; }
  /// 1 if the tip centre was below the surface in the last step, 0 if it was not; empty if unknown.
  std::optional<double> centre_inside() const noexcept {
    return if_any(tip_phi_.known, tip_phi_.value < 0.0 ? 1.0 : 0.0);
  }
  const Passage& passage() const noexcept { return passage_; }
  const CorePassage& core_passage() const noexcept { return core_passage_; }
  /// Returns true if the tool has gone through the surface and no later step can change this.
  bool has_passed() const noexcept { return passage_.deep || passage_.left || core_passage_.event(); }
  /// Searches the deepest points of the tool in the kept poses and returns the depths. Call after the run.
  InsideDepths depths();

 private:
  void check_tip(const StepRecord& record) noexcept;
  void march(const Vec3& point, double length, double time) noexcept;
  void update_side(const Vec3& point, const SurfaceDistance& phi, double time) noexcept;
  double find_deepest(InsideSearch& inside_search, InsideDepths& depths);

  std::shared_ptr<const ToolShape> tool_;
  std::shared_ptr<const Solid> solid_;
  const MetricsObserver* settled_by_;
  std::uint64_t every_;
  InsideSearch search_;
  std::optional<double> depth_;
  InsideDepths depths_;
  Passage passage_;
  double back_;  ///< distance of the core's front point behind the tip centre [m]

  bool began_ = false;
  Vec3 tip_checked_ = Vec3::Zero();  ///< position of the tip centre when its distance was last evaluated [m]
  /// Squared distance from tip_checked_ within which no new evaluation is needed [m^2]: while the front point is
  /// outside (tip_free2_), and while it is inside (tip_free2_inside_).
  double tip_free2_ = 0.0, tip_free2_inside_ = 0.0;
  SurfaceDistance tip_phi_;
  /// Last evaluated distance of the front point from the surface, and the position at which it was evaluated.
  std::optional<KnownDistance> core_distance_;
  Vec3 core_ = Vec3::Zero();    ///< front point of the core in the previous step [m]
  double free_distance_ = 0.0;  ///< distance that the front point can move without meeting the surface [m]
  SolidSide side_ = SolidSide::unknown;
  Vec3 outside_ = Vec3::Zero();       ///< last position of the front point outside [m]
  std::optional<Vec3> entry_normal_;  ///< outward normal at the entry; empty while the front point is outside
  CorePassage core_passage_;
  PoseSamples deepest_, settled_;
};

}  // namespace hapbench
