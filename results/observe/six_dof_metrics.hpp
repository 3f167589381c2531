#pragma once

#include <cstdint>
#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// One step of the comparison of a 3-DOF device, which renders a force, with a 6-DOF device, which renders force and
/// torque and is the reference. Both are in equilibrium with the same hand.
struct SixDofRow {
  /// Equilibrium of the 6-DOF device.
  struct Reference {
    Vec3 force = Vec3::Zero();     ///< force on the handle [N]
    Vec3 torque = Vec3::Zero();    ///< torque on the handle about the force point [N m]
    Vec3 position = Vec3::Zero();  ///< force point of the handle [m]
    Vec3 tip = Vec3::Zero();       ///< tip centre of the tool [m]
    Vec3 axis = Vec3::Zero();      ///< axis of the tool
    /// Rotation vector from the orientation that the hand intends to the handle's orientation [rad].
    Vec3 handle_turn = Vec3::Zero();
  };
  /// Equilibrium of the 3-DOF device, which renders the force of a law.
  struct Law {
    Vec3 force = Vec3::Zero();     ///< force on the handle [N]
    Vec3 position = Vec3::Zero();  ///< force point of the handle [m]
    double turn = 0.0;             ///< angle between this handle and the handle of the reference [rad]
  };
  std::optional<Reference> reference;  ///< empty: no equilibrium found
  std::optional<Law> law;              ///< empty: no equilibrium found; `turn` is only valid if there is a reference
  double residual = 0.0;               ///< largest residual of the reference [N]; see ToolEquilibrium::Outcome
  bool jumped = false;                 ///< true if the reference jumped to another equilibrium
};

/// Metrics of the comparison of a 3-DOF device with a 6-DOF device over a run (section six_dof of summary.json).
class SixDofMetrics {
 public:
  void add(const SixDofRow& row) noexcept;
  void report(Section& section) const;

 private:
  /// Root mean square and maximum of a value over the steps in which it exists.
  struct Size {
    double squares = 0.0, largest = 0.0;
    std::uint64_t count = 0;

    void add(double value) noexcept;
    double rms() const;
    std::optional<double> max() const;
  };
  /// Work of a force on a point by the trapezoidal rule over consecutive equilibria [J].
  struct Work {
    double sum = 0.0;
    std::optional<std::pair<Vec3, Vec3>> last;  ///< force [N] and position [m]

    void add(const Vec3& force, const Vec3& position) noexcept;
  };

  Size reference_force_, lost_torque_, force_error_, displacement_, turn_;
  Work work_;
  double residual_ = 0.0;
  std::uint64_t unsolved_ = 0, jumps_ = 0, unbalanced_ = 0;
};

}  // namespace hapbench
