#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "algorithms/proxy/nearest_point.hpp"
#include "algorithms/six_dof/pose_springs.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench::six_dof {

/// Largest residual [N] of the conditions of optimality at which a pose counts as an equilibrium. Rounding leaves
/// about 1e-13 N: forces of some newtons, and 20 000 N/m times positions of 10 mm.
inline constexpr double kSolved = 1e-9;

/// The pose of a tool with the smallest energy of its springs (PoseSprings) among the poses in which no shell point is
/// inside the tool,
///
///   minimise E(x, theta)   subject to   g_i(x, theta) >= 0 for all points,
///
/// with g_i the signed distance [m] of point i to the tool. Finds the local minimum that a descent from a given pose
/// reaches, by sequential quadratic programs: in each pass, the constraints near the tool are linearised,
///
///   -g_i + <m_i, dx> + <r_i x m_i, dtheta> <= 0,   m_i: outward normal of the tool at the point nearest to point i,
///                                                  r_i: from the force point to point i,
///
/// and the second derivatives of the constraints that hold the tool are added to those of the energy, which makes the
/// passes converge quadratically. A pass moves no point of the tool by more than a margin. A stationary pose whose
/// second derivatives show a descent, such as a cylinder balanced on one row of points, is left along this descent. A
/// search that does not leave it is not solved.
/// Unlike the proxy that translates, the constraints are those of the points alone: an edge of the tool may sink in
/// between points, by 2.5 um for a radius of 0.5 mm and points 0.1 mm apart.
///
/// Allocates in the constructor only.
class ToolEquilibrium {
 public:
  /// `force_point`: distance [m] from the tip centre back along the axis. Shell and tool must outlive the object.
  ToolEquilibrium(const PointShell& shell, const ToolShape& tool, double force_point, Skips skips);

  /// How a search ended. The residual is the largest of the force that the contacts do not balance, the moment that
  /// they do not balance over the reach of the tool, and K times the violation of a constraint and lambda_i |g_i| over
  /// the margin, in N.
  struct Outcome {
    bool solved = false;    ///< the residual is at most kSolved, and the second derivatives show a minimum
    bool feasible = false;  ///< the constraints of the last pass do not contradict each other
    double residual = 0.0;  ///< [N]
    double moved = 0.0;     ///< bound of the displacement of all points of the tool [m]
    int passes = 0;
  };
  /// Moves `pose` to the equilibrium. Without an outcome `solved`, the pose is that of the last pass.
  /// `max_passes`: a search that has not converged after them ends.
  Outcome solve(const PoseSprings& springs, CoupledPose& pose, int max_passes) noexcept;

  /// A point that holds the tool, with the force of magnitude `load` [N] along -normal on the tool.
  struct Holding {
    std::uint32_t index;
    Vec3 point, surface_normal;
    Vec3 normal;         ///< m_i
    double depth, load;  ///< -g_i [m], lambda_i [N]
    Vec6 row;            ///< (m_i, r_i x m_i)
  };
  /// The points that hold the tool after the last pass, at most six.
  std::span<const Holding> holding() const noexcept { return {holding_.data(), holding_count_}; }
  /// Tip centre, axis and roll of a tool in this pose; the roll is 0 for a solid of revolution.
  ToolPose tool_pose(const Vec3& position, const Eigen::Quaterniond& orientation) const noexcept;
  /// Distance [m] that the tool may move in a pass.
  double margin() const noexcept { return margin_; }
  std::size_t capacity() const noexcept { return near_->capacity(); }
  /// Largest depth of a point inside the tool at the pose of the last pass [m]; 0 without.
  double deepest() const noexcept { return deepest_; }
  /// Depths of points inside the tool are reduced to this value [m], so that the tool leaves them slowly, and a search
  /// with points inside or without room takes one pass. Infinite by default.
  void set_recovery(double depth) noexcept { recovery_ = depth; }
  void reset() noexcept;
  const SearchWork& work() const noexcept { return near_->work(); }

 private:
  struct Program;
  void find_constraints(const CoupledPose& pose) noexcept;
  Mat6 curvature(const CoupledPose& pose) noexcept;
  Vec6 row(const Vec3& position, const ContactBuffer& contacts, std::size_t i) const noexcept;
  bool solve_program(const PoseSprings& springs, const EnergyModel& model, const Mat6& hessian, Vec6& z) noexcept;
  struct SecondOrder {
    Mat6 hessian;  ///< positive definite
    Vec6 descent;  ///< move along which the energy descends, if the pose is no minimum
    bool is_minimum;
  };
  SecondOrder second_order(const PoseSprings& springs, const EnergyModel& model, const CoupledPose& pose) noexcept;
  double room(const Vec6& z) const noexcept;
  Vec6 nudge(const Vec6& descent, int n) const noexcept;
  double residual_of(const PoseSprings& springs, const EnergyModel& model) const noexcept;
  double displacement(const Vec6& z) const noexcept;

  const ToolShape* tool_;
  double force_point_, margin_, reach_;
  double recovery_;
  double deepest_ = 0.0;
  ToolShape::Grown grown_;
  std::unique_ptr<ContactQuery> near_;
  ContactBuffer contacts_;  ///< the points near the tool
  ContactBuffer probe_;     ///< the points that hold the tool, at poses nearby
  std::vector<Vec6> rows_, scaled_rows_;
  std::vector<double> scaled_depths_, scales_;
  std::array<Holding, 6> holding_;
  std::size_t holding_count_ = 0;
  bool feasible_ = true;
  bool leaving_ = false;  ///< true if the depths of the last pass were reduced
};

}  // namespace hapbench::six_dof
