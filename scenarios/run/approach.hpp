#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The way of the tip centre near the environment, and how close a tool came that touches nothing. A row costs some
/// nanoseconds; the distances from the surface itself are looked up after the run.
class Approach {
 public:
  /// The shell has points; the run has at most so many steps.
  Approach(std::shared_ptr<const PointShell> shell, std::uint64_t steps);

  /// `looks`: the tool has touched nothing yet.
  void add(const StepRecord& record, bool looks) noexcept;

  double longest_step() const { return longest_step_; }  ///< OutcomeObserver::longest_step [m]
  double distance() const { return distance_; }          ///< in the last row from the box; 0 within it [m]
  const Box& environment() const { return environment_; }

  struct Closest {
    double distance, time;  ///< of the tool from the nearest point [m], and when [s]
    /// Time to reach the surface at the speed of the last rows [s]; empty unless the last row was the closest.
    std::optional<double> rest = {};
  };
  /// In up to 256 rows before the first contact, of as many parts of the run those closest to the environment's box;
  /// within 1 %. Each search among all points tells how close the other rows can be at the least, since no point of the
  /// tool comes closer than it moves: a straight approach takes two.
  Closest closest_to_surface(const ToolShape& tool) const;

 private:
  static constexpr std::size_t kLooks = 256;
  struct Look {
    double time, from_box;
    ToolPose pose;
  };
  std::shared_ptr<const PointShell> shell_;
  Box environment_;
  Vec3 place_ = Vec3::Zero();  ///< in the last row
  double time_ = 0.0;          ///< of the last row
  double distance_ = std::numeric_limits<double>::infinity(), longest_step_ = 0.0;
  std::uint64_t every_;
  std::vector<Look> looks_;
};

}  // namespace hapbench
