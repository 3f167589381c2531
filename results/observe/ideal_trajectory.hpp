#pragma once

#include <cstdint>
#include <optional>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/loop/observer.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// Where the tip's centre is, in the vertical plane through the hole's axis in which the tool leans.
struct TipPlace {
  double lateral = 0.0;  ///< from the hole's axis, towards where the tool leans [m]
  double height = 0.0;   ///< above the hole's mouth, so negative in the hole [m]
};

/// The ideal trajectory of thesis 3.6, which is a formula for the thesis's drill, a flat-tipped cylinder: this file and
/// interpenetration.hpp are about that one tool and ask no ToolShape. A flat-tipped tool of radius r, tilted by alpha
/// in a hole of radius R and depth H, touches the wall with the lower edge of its tip and the rim opposite with its
/// side:
///
///   lateral = -R + r cos(alpha),  height = (r (1 + cos^2 alpha) - 2 R cos(alpha)) / sin(alpha)
///
/// Returns nothing if there is no such contact: the tip's edge above the mouth, or its other edge below the hole's
/// bottom, or no tilt in (0, pi / 2).
std::optional<TipPlace> ideal_place(const BlockWithHole& block, double tool_radius, double tilt);

/// Hands that push with less than this are gentle [N]: the thesis splits its figure 7 there.
inline constexpr double kGentleForce = 2.0;

/// How far one row is from the ideal trajectory.
struct TrajectoryError {
  double tilt = 0.0;  ///< [rad]
  TipPlace actual;
  TipPlace ideal;
  double interpenetration = 0.0;  ///< true depth of the tool in the block [m]
  double hand_force = 0.0;        ///< norm [N]
};

/// Over the compared rows of one kind of hand. Errors are actual minus ideal [m]: a negative height error has sunk in.
struct TrajectoryErrors {
  std::uint64_t rows = 0;
  double height_mean = 0.0, height_rms = 0.0, height_min = 0.0, height_max = 0.0;
  double lateral_mean = 0.0, lateral_rms = 0.0, lateral_max_abs = 0.0;
  double interpenetration_mean = 0.0, interpenetration_max = 0.0;
};

struct IdealTrajectoryMetrics {
  TrajectoryErrors gentle;               ///< hand below kGentleForce
  TrajectoryErrors firm;                 ///< the rest
  std::uint64_t rows_without_ideal = 0;  ///< tilts at which the ideal trajectory does not exist
};

/// Compares rows 0, every, 2 every, … with the ideal trajectory and with the exact hole. Allocates nothing; about 2 us
/// for each of them.
class IdealTrajectoryObserver final : public Observer {
 public:
  /// Precondition: every > 0.
  IdealTrajectoryObserver(const BlockWithHole& block, const Cylinder& tool, std::uint64_t every = 1);

  void on_step(const StepRecord& record) noexcept override;

  /// Error of the last row; nothing where the ideal trajectory does not exist, and for rows that are not compared.
  const std::optional<TrajectoryError>& error() const noexcept { return error_; }
  IdealTrajectoryMetrics metrics() const noexcept;

 private:
  /// Sums where the metrics have means.
  static void add(TrajectoryErrors& sums, const TrajectoryError& error) noexcept;

  BlockWithHole block_;
  Cylinder tool_;
  std::uint64_t every_;
  std::optional<TrajectoryError> error_;
  IdealTrajectoryMetrics sums_;
};

}  // namespace hapbench
