#include "results/observe/ideal_trajectory.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kSamples = 64;
constexpr double kStep = 2.0 * std::numbers::pi / kSamples;  // [rad]
constexpr double kAngleTolerance = 1e-8;                     // [rad]

struct Turn {
  double cosine, sine;
};

const std::array<Turn, kSamples> kTurns = [] {
  std::array<Turn, kSamples> turns{};
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double angle = static_cast<double>(i) * kStep;
    turns[i] = {math::cos(angle), math::sin(angle)};
  }
  return turns;
}();

/// The side surface of the tool as straight lines, one for each angle about the tool's axis.
class Side {
 public:
  Side(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose)
      : tip_(pose.position),
        up_(-pose.axis),
        e1_(tool.radius() * pose.axis.unitOrthogonal()),
        e2_(pose.axis.cross(e1_)),
        steepness_(up_.head<2>().squaredNorm() - up_.z() * up_.z()),
        length_(tool.length()),
        radius_(block.hole_diameter / 2),
        block_(block) {}

  /// Returns the depth of the deepest point of a line [m], negative if the whole line is outside.
  double deepest(const Turn& turn) const {
    const Vec3 end = tip_ + turn.cosine * e1_ + turn.sine * e2_;
    const double deep = depth(end), up_to_cone = to_cone(end);
    return up_to_cone > 0.0 ? std::max(deep, depth(end + std::min(up_to_cone, length_) * up_)) : deep;
  }
  double deepest(double angle) const { return deepest({math::cos(angle), math::sin(angle)}); }

 private:
  /// Returns the depth below the block's surface [m], negative outside the block. Inside the block, the depth is the
  /// exact distance to the block's surface.
  double depth(const Vec3& q) const {
    const double out = std::sqrt(q.x() * q.x() + q.y() * q.y()) - radius_, below = -block_.hole_depth - q.z();
    const double hole = out > 0.0 && below > 0.0 ? std::sqrt(out * out + below * below) : std::max(out, below);
    return std::min({hole, -q.z(), q.z() + block_.size.z(), block_.size.x() / 2 - std::abs(q.x()),
                     block_.size.y() / 2 - std::abs(q.y())});
  }

  /// Returns the distance from the line's end at the tip, up the line, to the cone rho = R - z [m]; 0 if the end is
  /// not within the cone. rho is the distance from the hole's axis, R the radius of the hole.
  double to_cone(const Vec3& end) const {
    // The point at the distance s up the line is on the cone if rho^2 = (R - z)^2, that is steepness_ s^2 + 2 b s + c =
    // 0. This equation also holds on the mirrored cone rho = z - R. The smallest positive root s is on the cone with
    // R - z > 0.
    const double height = radius_ - end.z();
    const double c = end.head<2>().squaredNorm() - height * height;
    if (height <= 0.0 || c >= 0.0) return 0.0;
    const double b = end.head<2>().dot(up_.head<2>()) + height * up_.z();
    const double root = std::sqrt(b * b - steepness_ * c);
    return b < 0.0 ? (root - b) / steepness_ : -c / (b + root);  // avoids a difference of nearly equal numbers
  }

  Vec3 tip_, up_, e1_, e2_;
  double steepness_, length_, radius_;
  const BlockWithHole& block_;
};

/// Returns the maximum of f in [low, high], if f has a single maximum there, by Brent's method (R. P. Brent,
/// Algorithms for Minimization without Derivatives, 1973, chapter 5). A step goes to the vertex of the parabola
/// through the three best points so far. If the vertex is not well inside the interval, the step is a golden section.
/// `best`: start point in the interval. `top`: f(best).
template <class Function>
// NOLINTNEXTLINE(readability-function-cognitive-complexity): follows the published algorithm step by step.
double maximum_in(const Function& f, double low, double high, double best, double top) {
  constexpr double kGolden = 2.0 - std::numbers::phi;
  double second = best, third = best, f_second = top, f_third = top;
  double step = 0.0, last_step = 0.0;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (std::abs(best - middle) + 0.5 * (high - low) <= 2.0 * kAngleTolerance) return top;
    // The vertex of the parabola is at best + p / q.
    const double r = (best - second) * (top - f_third), s = (best - third) * (top - f_second);
    const double p = std::copysign(1.0, r - s) * ((best - third) * s - (best - second) * r);
    const double q = 2.0 * std::abs(s - r);
    // Take the parabola's vertex if it is well inside and the steps shrink, otherwise a golden section.
    const bool parabola = std::abs(p) < std::abs(0.5 * q * last_step) && p > q * (low - best) && p < q * (high - best);
    last_step = parabola ? step : (best < middle ? high : low) - best;
    step = parabola ? p / q : kGolden * last_step;
    if (parabola && std::min(best + step - low, high - best - step) < 2.0 * kAngleTolerance)
      step = std::copysign(kAngleTolerance, middle - best);
    if (std::abs(step) < kAngleTolerance) step = std::copysign(kAngleTolerance, step);
    // Narrow the interval and keep the three best points.
    const double x = best + step, f_x = f(x);
    if (f_x >= top) {
      (x < best ? high : low) = best;
      third = second, f_third = f_second;
      second = best, f_second = top;
      best = x, top = f_x;
    } else {
      (x < best ? low : high) = x;
      if (f_x >= f_second || second == best) {
        third = second, f_third = f_second;
        second = x, f_second = f_x;
      } else if (f_x >= f_third || third == best || third == second) {
        third = x, f_third = f_x;
      }
    }
  }
}

}  // namespace

double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose) {
  assert(pose.axis.z() <= 0.0);
  const Side side(block, tool, pose);
  // Compute the depth of each line.
  std::array<double, kSamples> depth{};
  for (std::size_t i = 0; i < kSamples; ++i) depth[i] = side.deepest(kTurns[i]);
  double largest = std::max(0.0, *std::max_element(depth.begin(), depth.end()));
  // Search near each line that is deeper than its neighbours. Neighbouring lines are at most radius * step apart,
  // so their depths differ by at most this distance.
  const double reach = tool.radius() * kStep;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double before = depth[(i + kSamples - 1) % kSamples], after = depth[(i + 1) % kSamples];
    if (!(depth[i] > before && depth[i] >= after) || 0.5 * (depth[i] + std::max(before, after) + reach) <= largest)
      continue;
    const double angle = static_cast<double>(i) * kStep;
    const auto at = [&side](double x) { return side.deepest(x); };
    largest = std::max(largest, maximum_in(at, angle - kStep, angle + kStep, angle, depth[i]));
  }
  return largest;
}

std::optional<TipPosition> ideal_tip_position(const BlockWithHole& block, double tool_radius, double tilt) {
  if (!(tilt > 0.0 && tilt < std::numbers::pi / 2)) return std::nullopt;
  const double R = block.hole_diameter / 2, r = tool_radius;
  const double cosine = math::cos(tilt), sine = math::sin(tilt);
  const TipPosition position{-R + r * cosine, (r * (1.0 + cosine * cosine) - 2.0 * R * cosine) / sine};
  const bool edge_in_hole =
      position.height + r * sine<0.0, above_bottom = position.height - r * sine> - block.hole_depth;
  if (!edge_in_hole || !above_bottom) return std::nullopt;
  return position;
}

IdealTrajectoryObserver::IdealTrajectoryObserver(const BlockWithHole& block, const Cylinder& tool, std::uint64_t every)
    : block_(block), tool_(tool), every_(every) {
  assert(every > 0);
}

void IdealTrajectoryObserver::begin(const TrialParts& trial) {
  *this = IdealTrajectoryObserver(block_, dynamic_cast<const Cylinder&>(*trial.simulation.tool), every_);
}

void IdealTrajectoryObserver::on_step(const StepRecord& record) noexcept {
  error_.reset();
  if (record.step % every_ != 0) return;
  const ToolPose& pose = record.tool.pose;
  const Vec3 lean{-pose.axis.x(), -pose.axis.y(), 0.0};
  const double sine = lean.norm(), tilt = math::atan2(sine, -pose.axis.z());
  const auto ideal = ideal_tip_position(block_, tool_.radius(), tilt);
  if (!ideal) {
    ++rows_without_ideal_;
    return;
  }
  TrajectoryError& error = error_.emplace();
  error.tilt = tilt;
  error.actual = {pose.position.dot(lean) / sine, pose.position.z()};
  error.ideal = *ideal;
  error.interpenetration = interpenetration(block_, tool_, pose);
  error.hand_force = record.hand_force.norm();
  (error.hand_force < kGentleForce ? gentle_ : firm_).add(error);
}

void IdealTrajectoryObserver::Errors::report(Section s) const {
  const auto rms = [this](const Spread& of) { return std::sqrt(per(of.squares, rows)); };
  s.metric(
      "rows", "1",
      "number of recorded steps at whose tilt the ideal trajectory exists, with hand_force_N of ideal_trajectory.csv "
      "below 2 N (gentle) or of at least 2 N (firm); the other metrics are over these steps",
      rows);
  s.metric(
       "height_error_mean_m", "m",
       "mean height error (height_m - ideal_height_m of ideal_trajectory.csv) over the compared steps; negative: the "
       "tool sank in",
       per(height.sum, rows))
      .has_either_sign();
  s.metric("height_error_rms_m", "m",
           "root mean square of the height error (height_m - ideal_height_m of ideal_trajectory.csv)", rms(height),
           Better::less);
  s.metric("height_error_min_m", "m",
           "smallest (most negative) height error (height_m - ideal_height_m of ideal_trajectory.csv)", height.min)
      .has_either_sign();
  s.metric("height_error_max_m", "m", "largest height error (height_m - ideal_height_m of ideal_trajectory.csv)",
           height.max);
  s.metric(
       "lateral_error_mean_m", "m",
       "mean lateral error (lateral_m - ideal_lateral_m of ideal_trajectory.csv), positive in the direction in which "
       "the tool leans",
       per(lateral.sum, rows))
      .has_either_sign();
  s.metric("lateral_error_rms_m", "m",
           "root mean square of the lateral error (lateral_m - ideal_lateral_m of ideal_trajectory.csv)", rms(lateral),
           Better::less);
  s.metric("lateral_error_max_m", "m",
           "largest absolute lateral error |lateral_m - ideal_lateral_m of ideal_trajectory.csv|",
           std::max(lateral.max, -lateral.min), Better::less);
  s.metric("interpenetration_mean_m", "m",
           "mean interpenetration (interpenetration_m of ideal_trajectory.csv): depth of the tool in the exact block, "
           "computed from the shapes and not from the shell",
           per(interpenetration.sum, rows), Better::less);
  s.metric(
      "interpenetration_max_m", "m",
      "largest interpenetration (interpenetration_m of ideal_trajectory.csv): depth of the tool in the exact block, "
      "computed from the shapes and not from the shell",
      interpenetration.max, Better::less);
}

void IdealTrajectoryObserver::report(Section& s) const {
  gentle_.report(s.part("gentle"));
  firm_.report(s.part("firm"));
  s.metric(
      "rows_without_ideal", "1",
      "number of recorded steps at whose tilt the ideal trajectory does not exist: lines of trajectory.csv without a "
      "line in ideal_trajectory.csv",
      rows_without_ideal_);
}

}  // namespace hapbench
