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

/// How deep the tool was in the environment, in a trial or in several.
struct InsideDepths {
  std::optional<double> max;    ///< of any point of the tool in any row [m]
  std::vector<double> settled;  ///< of rows in settled contact [m]
  /// How much `max` and `settled` may be too low, on top of InsideSearch::kTolerance of them [m].
  double max_within = 0.0, settled_within = 0.0;
  std::uint64_t rows = 0;  ///< with the tip centre where the inside is known
  std::uint64_t centre_inside = 0;

  std::optional<double> settled_median() const;
  /// The deepest that a row can be whose deepest point was looked for [m].
  double searched_max() const { return (1.0 + InsideSearch::kTolerance) * max.value_or(0.0); }
  /// Adds the depths of another trial.
  void add(const InsideDepths& trial);
  /// Tells the metrics; `has_settled`: settled contact was long enough for those of it.
  void tell(Section& section, bool has_settled) const;
};

/// How the tool passed the surface in a run: by its tip centre, and by the foremost place of its core, half the tool's
/// width within the body behind its tip (of a ball the tip centre, of a flat tip half a width behind it). By the rest
/// of its core: CorePassage.
struct Passage {
  struct Event {
    double time;  ///< [s]
    Vec3 place;   ///< [m]
  };
  std::optional<Event> deep;               ///< when the tip centre first was deeper than the half width
  double deepest = 0.0, last_depth = 0.0;  ///< of the tip centre in any row, within 2 %, and in the last one [m]
  bool began_inside = false, ends_inside = false;  ///< that place, in the first and in the last row
  /// When that place first left the solid on another side than it came, and where it had entered: the surface faces the
  /// other way there, by more than a right angle.
  std::optional<Event> left;
  Vec3 entered = Vec3::Zero();  ///< [m]

  bool went_through() const noexcept { return deep || left || ends_inside; }
};

/// Distance from the tip centre back to the place half the tool's width within the body [m]; of a ball 0.
double way_to_core(const ToolShape& tool);

/// On which side of the surface a place is; unknown beyond the border of an open one.
enum class SolidSide { unknown, outside, inside };

/// Finds a tool that goes through a wall, also one thinner than the tool: by its core, the part of its axis that is in
/// its body, from the tip centre to the far end. While no contact is deep, the core of a flat tip begins 0.9 half
/// widths behind the tip centre, because its tip centre is in the surface at any depth. The core has gone through when
/// it crosses the solid from face to face at one time, the faces looking away from each other, or when a part of it
/// comes out by a face that looks away from the one by which it had entered. A row costs a look, some 20 distances
/// along the axis, only while a contact is deep (looks_from_) or the way of a row long, once the core has moved by its
/// distance from the surface, and before the first passage. Allocates when constructed.
class CorePassage {
 public:
  struct Event {
    double time;         ///< [s]
    Vec3 entered, left;  ///< [m]
    bool at_once;        ///< from face to face
  };

  CorePassage(const ToolShape& tool, std::shared_ptr<const Solid> solid);

  /// A row: its deepest contact, and how far the tip centre or a place near it moved [m].
  void add(const ToolPose& pose, double deepest_contact, double moved, double time) noexcept {
    if (event_) return;
    if (deepest_contact >= looks_from_ || moved > looks_from_way_) {
      look(pose, deepest_contact, time);
    } else {
      free_way_ = 0.0;
      follows_ = false;
    }
    position_ = pose.position;
    axis_ = pose.axis;
    began_ = true;
  }

  const std::optional<Event>& event() const noexcept { return event_; }

 private:
  /// A stretch of the core that is inside, from `low` to `high` on the axis [m].
  struct Stretch {
    double low, high;
    std::optional<Vec3> face_low, face_high;  ///< outward normals where it ends at the surface
    double deepest;                           ///< phi, the least [m]
    Vec3 deepest_place;
    /// The face by which it entered, where, and the part that did.
    Vec3 normal = Vec3::Zero(), entered = Vec3::Zero();
    double own_low = 0.0, own_high = 0.0;
    bool goes_on = false;  ///< a stretch of the next look meets it
  };

  void look(const ToolPose& pose, double deepest_contact, double time) noexcept;
  double find_inside(const Vec3& position, const Vec3& axis, double front) noexcept;
  void compare(const Vec3& position, const Vec3& axis, double time) noexcept;
  Vec3 normal_at(const Vec3& place) const noexcept;

  std::shared_ptr<const Solid> solid_;
  double width_;                        ///< half the tool's [m]
  double far_;                          ///< the core's far end on the axis [m]
  double shallow_;                      ///< where it begins while no contact is deep [m]
  double looks_from_, looks_from_way_;  ///< depth of a contact, and way in a row [m]

  Vec3 position_ = Vec3::Zero(), axis_ = Vec3::Zero();  ///< in the row before
  bool began_ = false, follows_ = false;                ///< there was a row before; it was also looked at
  double free_way_ = 0.0;                               ///< of the core, on which nothing changes [m]
  std::vector<Stretch> now_, inside_;                   ///< of this look and of the one before
  std::optional<Event> event_;
};

/// Keeps poses of a run in a fixed memory: of some parts of equally many rows each the one with the largest key, and
/// how far the others are from it.
class PoseSamples {
 public:
  struct Sample {
    ToolPose pose;
    double key;
    double way = 0.0;  ///< the most by which a point of the tool is elsewhere in another row [m]
  };
  /// `most`: even. The tool must outlive the samples.
  PoseSamples(std::size_t most, const ToolShape& tool) : most_(most), tool_(tool) { samples_.reserve(most); }
  void add(const ToolPose& pose, double key) noexcept {
    if (rows_left_ == 0) return begin_part(pose, key);
    --rows_left_;
    Sample& part = samples_.back();
    const double moved = tool_.moved_at_most(part.pose, pose);
    if (key > part.key) {
      part = {pose, key, part.way + moved};
    } else if (moved > part.way) {
      part.way = moved;
    }
  }
  const std::vector<Sample>& all() const noexcept { return samples_; }

 private:
  std::size_t most_;
  const ToolShape& tool_;
  Sample joined(const Sample& a, const Sample& b) const noexcept;
  void begin_part(const ToolPose& pose, double key) noexcept;

  std::vector<Sample> samples_;
  std::uint64_t rows_left_ = 0, rows_of_part_ = 1;  ///< rows to come of the last part
};

/// Watches how deep the tool is in one trial. A row costs some ten nanoseconds: a point cannot pass the surface before
/// it has moved by its distance, so that few rows need a look. The deepest point of the tool is looked for after the
/// run, in the rows with the deepest contact or centre, in those that may be deeper still (InsideBound), and in some in
/// settled contact; or in every `every`-th row. Does not allocate during the run.
class InsideObserver final : public Observer {
 public:
  /// `metrics`, if given, observes before this and tells which rows are in settled contact. `every`: 0 where no row is
  /// looked at during the run. `steps`: how many rows the run has.
  InsideObserver(std::shared_ptr<const ToolShape> tool, std::shared_ptr<const Solid> solid,
                 const MetricsObserver* metrics = nullptr, std::uint64_t every = 0, std::uint64_t steps = 0);

  void on_step(const StepRecord& record) noexcept override;

  /// Depth of the tool in the last row [m]; empty if unknown and in rows that are not looked at.
  const std::optional<double>& depth() const noexcept { return depth_; }
  const Passage& passage() const noexcept { return passage_; }
  const CorePassage& core_passage() const noexcept { return core_passage_; }
  /// After the run; looks for the deepest points.
  InsideDepths depths();

 private:
  void look_at_tip(const StepRecord& record) noexcept;
  void march(const Vec3& place, double length, double time) noexcept;
  void note_core(const Vec3& place, const SurfaceDistance& phi, double time) noexcept;
  double find_deepest(InsideDepths& depths);

  std::shared_ptr<const ToolShape> tool_;
  std::shared_ptr<const Solid> solid_;
  const MetricsObserver* settled_by_;
  std::uint64_t every_;
  InsideSearch search_;
  std::optional<double> depth_;
  InsideDepths depths_;
  Passage passage_;
  double back_;  ///< of the core behind the tip centre [m]

  bool began_ = false;
  Vec3 tip_looked_ = Vec3::Zero();  ///< where the tip centre's distance was last looked up
  /// The square of the way from there that needs no look [m^2], with the core outside and inside.
  double tip_free2_ = 0.0, tip_free2_inside_ = 0.0;
  SurfaceDistance tip_phi_;
  Vec3 core_ = Vec3::Zero();  ///< in the row before
  double free_way_ = 0.0;     ///< of the core, on which it cannot meet the surface [m]
  SolidSide side_ = SolidSide::unknown;
  Vec3 outside_ = Vec3::Zero();  ///< where the core was last seen outside
  std::optional<Vec3> entry_normal_;
  CorePassage core_passage_;
  PoseSamples deepest_, settled_;
};

}  // namespace hapbench
