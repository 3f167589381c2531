#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// Returns the true interpenetration of a flat-tipped cylinder with the block [m]: the depth below the block's
/// surface of the tool's deepest point, computed from the exact shapes and not from a point shell; 0 if they do not
/// overlap. Valid for a tool that touches the hole and the top face around it; the block's other edges are ignored.
///
/// Method: near the hole the depth is min(D, -z), where D is the signed distance from the hole without its mouth. D
/// is a convex function, equal to rho - R above the hole's bottom (rho: distance from the hole's axis, R: hole
/// radius). Along each straight line on the side of the cylinder, upwards from the tip, -z decreases. So the deepest
/// point of a line is its end at the tip, or its point with D = -z. All points with D = -z lie on the 45-degree cone
/// that opens downwards from the rim. (The interior of the tip's flat face contains no deeper point: along a horizontal
/// line in this face z is constant, and the convex D is largest at an end.) The depths of two lines differ by at most
/// radius * angle between them. 64 lines around the tool are evaluated. Near each line that is deeper than both of
/// its neighbours, the angle of the deepest line is searched to 1e-8 rad. This gives a depth accurate to about 1e-11
/// m. Takes about 2 us. Precondition: the tool does not point upwards, axis.z <= 0.
double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose);

/// Position of the tip centre in the vertical plane that contains the hole's axis and the direction in which the tool
/// leans.
struct TipPosition {
  double lateral = 0.0;  ///< distance from the hole's axis, positive in the direction in which the tool leans [m]
  double height = 0.0;   ///< height above the hole's mouth, negative in the hole [m]
};

/// Returns the tip position of the ideal trajectory (thesis 3.6). A flat-tipped cylinder of radius r, like the
/// thesis's drill, is tilted by alpha in a hole of radius R. It touches the wall with the lower edge of its tip and
/// the opposite rim with its side:
///
///   lateral = -R + r cos(alpha),  height = (r (1 + cos^2 alpha) - 2 R cos(alpha)) / sin(alpha)
///
/// Returns nothing if this contact does not exist: the tip's lower edge is above the mouth, the tip reaches below
/// the hole's bottom, or the tilt is outside (0, pi / 2).
std::optional<TipPosition> ideal_tip_position(const BlockWithHole& block, double tool_radius, double tilt);

/// Hand forces below this value count as gentle, all others as firm [N]. The thesis divides its figure 7 at this
/// force.
inline constexpr double kGentleForce = 2.0;

/// Deviation of one step from the ideal trajectory.
struct TrajectoryError {
  double tilt = 0.0;  ///< angle between the axes of tool and hole [rad]
  TipPosition actual;
  TipPosition ideal;
  double interpenetration = 0.0;  ///< true depth of the tool in the block [m]
  double hand_force = 0.0;        ///< norm of the hand's force [N]
};

/// Compares steps 0, every, 2 every, … with the ideal trajectory and the exact hole. Allocates nothing; about 2 us
/// for a compared step.
class IdealTrajectoryObserver final : public MetricObserver {
 public:
  /// Precondition: every > 0.
  explicit IdealTrajectoryObserver(const BlockWithHole& block = {}, const Cylinder& tool = {}, std::uint64_t every = 1);

  /// Precondition: the trial's tool is a cylinder.
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;

  /// Deviation in the last step; empty if the ideal trajectory does not exist at the tilt of the tool in this step, or
  /// if the step is not compared.
  const std::optional<TrajectoryError>& error() const noexcept { return error_; }
  void report(Section& section) const override;

 private:
  /// Sums [m, m^2] and extremes [m] of a length over the compared steps; without steps, the extremes are not
  /// finite.
  struct Spread {
    double sum = 0.0, squares = 0.0;
    double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();

    void add(double value) noexcept {
      sum += value;
      squares += value * value;
      min = std::min(min, value);
      max = std::max(max, value);
    }
  };
  /// Statistics over the compared steps with gentle or with firm hand force: actual minus ideal position, and
  /// interpenetration.
  struct Errors {
    std::uint64_t rows = 0;
    Spread height, lateral, interpenetration;

    void add(const TrajectoryError& error) noexcept {
      height.add(error.actual.height - error.ideal.height);
      lateral.add(error.actual.lateral - error.ideal.lateral);
      interpenetration.add(error.interpenetration);
      ++rows;
    }
    void report(Section section) const;
  };

  BlockWithHole block_;
  Cylinder tool_;
  std::uint64_t every_;
  std::optional<TrajectoryError> error_;
  Errors gentle_, firm_;                  ///< errors at hand forces below kGentleForce, and at all other hand forces
  std::uint64_t rows_without_ideal_ = 0;  ///< compared steps at whose tilt the ideal trajectory does not exist
};

}  // namespace hapbench
