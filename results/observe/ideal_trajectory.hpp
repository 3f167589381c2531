#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// True interpenetration of a flat-tipped cylinder with the block [m]: the depth below the block's surface of the
/// tool's deepest point, from the exact shapes and not from a shell; 0 when they do not overlap. Valid for a tool that
/// touches the hole and the top face around it; the block's other edges are ignored.
///
/// Near the hole the depth is min(D, -z), D the signed distance from the hole without its mouth: a convex function,
/// equal to rho - R above the hole's bottom. Along each straight line of the tool's side, going up from the tip, -z
/// falls, so that the deepest point is the line's end in the tip or where D = -z, on the cone of 45 degrees that opens
/// downwards from the rim. (Inside the tip's flat no point is deepest: a horizontal way out of it keeps z, and D does
/// not fall both ways.) Depths of lines differ by at most radius * angle between them: of 64 lines round the tool, the
/// angles about those deeper than their neighbours are searched to 1e-8 rad, for a depth to about 1e-11 m. About 2 us.
/// Precondition: the tool does not point upwards, axis.z <= 0.
double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose);

/// Position of the tip's centre in the vertical plane through the hole's axis in which the tool leans.
struct TipPlace {
  double lateral = 0.0;  ///< from the hole's axis, towards where the tool leans [m]
  double height = 0.0;   ///< above the hole's mouth, so negative in the hole [m]
};

/// The ideal trajectory of thesis 3.6: a flat-tipped cylinder of radius r, like the thesis's drill, tilted by alpha in
/// a hole of radius R, touches the wall with the lower edge of its tip and the opposite rim with its side:
///
///   lateral = -R + r cos(alpha),  height = (r (1 + cos^2 alpha) - 2 R cos(alpha)) / sin(alpha)
///
/// Returns nothing if there is no such contact: the tip's edge above the mouth, or its other edge below the hole's
/// bottom, or no tilt in (0, pi / 2).
std::optional<TipPlace> ideal_place(const BlockWithHole& block, double tool_radius, double tilt);

/// Hands that push with less than this force are gentle [N]: the thesis divides its figure 7 there.
inline constexpr double kGentleForce = 2.0;

/// Deviation of one row from the ideal trajectory.
struct TrajectoryError {
  double tilt = 0.0;  ///< [rad]
  TipPlace actual;
  TipPlace ideal;
  double interpenetration = 0.0;  ///< true depth of the tool in the block [m]
  double hand_force = 0.0;        ///< norm [N]
};

/// Compares rows 0, every, 2 every, … with the ideal trajectory and the exact hole. Allocates nothing; about 2 us each.
class IdealTrajectoryObserver final : public MetricObserver {
 public:
  /// Precondition: every > 0.
  explicit IdealTrajectoryObserver(const BlockWithHole& block = {}, const Cylinder& tool = {}, std::uint64_t every = 1);

  /// Precondition: the trial's tool is a cylinder.
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;

  /// Error of the last row; nothing where the ideal trajectory does not exist or the row is not compared.
  const std::optional<TrajectoryError>& error() const noexcept { return error_; }
  void tell(Section& section) const override;

 private:
  /// Sums and extremes of a length over rows [m, m^2]; the extremes are not finite without rows.
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
  /// Sums over the compared rows of one kind of hand: actual minus ideal place, and the interpenetration.
  struct Errors {
    std::uint64_t rows = 0;
    Spread height, lateral, interpenetration;

    void add(const TrajectoryError& error) noexcept {
      height.add(error.actual.height - error.ideal.height);
      lateral.add(error.actual.lateral - error.ideal.lateral);
      interpenetration.add(error.interpenetration);
      ++rows;
    }
    void tell(Section section) const;
  };

  BlockWithHole block_;
  Cylinder tool_;
  std::uint64_t every_;
  std::optional<TrajectoryError> error_;
  Errors gentle_, firm_;                  ///< of hands below kGentleForce, and of the rest
  std::uint64_t rows_without_ideal_ = 0;  ///< tilts at which the ideal trajectory does not exist
};

}  // namespace hapbench
