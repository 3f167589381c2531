#include "results/record/trajectory_extras.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "results/observe/inside_observer.hpp"

namespace hapbench {
namespace {

/// w, x, y, z; of the two quaternions of one rotation the one with w >= 0.
std::array<double, 4> quaternion(const Mat3& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
}

constexpr Column kPoseColumns[] = {
    {"qw", "1", "w of the unit quaternion that turns the tool's frame, its axis along -z, into the world's; >= 0"},
    {"qx", "1", "x of this quaternion"},
    {"qy", "1", "y of this quaternion"},
    {"qz", "1", "z of this quaternion"}};
constexpr Column kTorqueColumns[] = {
    {"tx_Nm", "Nm",
     "x of the lost torque: what the rendered contacts would exert on the tool about its tip's centre and the device "
     "cannot render, sum r_i x f_i, f_i contact i's share of f_spring"},
    {"ty_Nm", "Nm", "y of the lost torque"},
    {"tz_Nm", "Nm", "z of the lost torque"}};
constexpr Column kInsideColumns[] = {
    {"inside_m", "m",
     "largest distance below the environment's surface of any point of the tool (inside_max_m); empty of springs and "
     "beyond the border of an open surface"}};

constexpr TrajectoryGroup kGroups[] = {
    {&TrajectoryExtras::pose, "pose", "add the tool's orientation to trajectory.csv, as a quaternion qw,qx,qy,qz",
     kPoseColumns,
     [](const StepRecord& r, const InsideObserver*, std::optional<double>* cells) {
       const ToolPose pose{r.tool.pose.position, r.tool.pose.axis, r.roll};
       std::ranges::copy(quaternion(pose.rotation()), cells);
     },
     true},
    {&TrajectoryExtras::torque, "torque",
     "add the torque that is lost to trajectory.csv, tx_Nm,ty_Nm,tz_Nm, and its metrics: what the rendered "
     "contacts would exert about the tip centre and the device cannot render",
     kTorqueColumns,
     [](const StepRecord& r, const InsideObserver*, std::optional<double>* cells) {
       std::copy(r.springs.moment.begin(), r.springs.moment.end(), cells);
     },
     false, true},
    {&TrajectoryExtras::inside, "inside",
     "add how deep the tool is in the environment to trajectory.csv, inside_m, and take its metrics from every "
     "recorded row",
     kInsideColumns, [](const StepRecord&, const InsideObserver* inside, std::optional<double>* cells) {
       *cells = inside != nullptr ? inside->depth() : std::nullopt;
     }}};

}  // namespace

std::span<const TrajectoryGroup> trajectory_groups() {
  return kGroups;
}

}  // namespace hapbench
