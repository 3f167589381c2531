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

/// Observes how close the tool comes to the environment before the first contact. Each step costs a few
/// nanoseconds, because it only measures the distance of the tip centre from the environment's bounding box.
/// Distances from the surface itself are computed after the run.
class Approach {
 public:
  /// Precondition: `shell` has at least one point. `steps`: largest number of steps of the run.
  Approach(std::shared_ptr<const PointShell> shell, std::uint64_t steps);

  /// Adds a step. `before_contact`: true if the tool has not touched the environment in this step or any
  /// earlier step.
  void add(const StepRecord& record, bool before_contact) noexcept;

  /// Returns the longest displacement of the tip in a step near the surface [m], as defined at
  /// OutcomeObserver::longest_step().
  double longest_step() const { return longest_step_; }
  /// Distance of the tip centre from the environment's bounding box in the last step [m]; 0 inside the box.
  double distance() const { return distance_; }
  const Box& environment() const { return environment_; }

  struct Closest {
    /// distance: distance of the tool from the nearest surface point [m]. time: time of the step with this distance
    /// [s].
    double distance, time;
    /// Time that the tool still needed to reach the surface at the speed of its last steps [s]. Empty if the tool was
    /// closest to the surface before the last step, or if it did not approach the surface in the last steps.
    std::optional<double> time_to_contact = {};
    bool is_estimate = false;  ///< as Gap::is_estimate
  };
  /// Returns the smallest distance of the tool from the surface points before the first contact, within 1 %.
  /// The run is divided into at most 256 intervals, and the step closest to the environment's bounding box in each
  /// interval is a candidate. The search for the surface point nearest to the tool in one candidate also gives lower
  /// bounds for the distances in the other candidates, because no point of the tool approaches the surface by more than
  /// it moves. For a tool that approaches the surface on a straight line, two searches are sufficient.
  Closest closest_to_surface(const ToolShape& tool) const;

 private:
  static constexpr std::size_t kMaxCandidates = 256;
  struct Candidate {
    double time, from_box;
    ToolPose pose;
  };
  std::shared_ptr<const PointShell> shell_;
  Box environment_;
  Vec3 position_ = Vec3::Zero();  ///< position of the tip centre in the last step [m]
  double time_ = 0.0;             ///< time of the last step [s]
  double distance_ = std::numeric_limits<double>::infinity(), longest_step_ = 0.0;
  std::uint64_t interval_;
  std::vector<Candidate> candidates_;
};

}  // namespace hapbench
