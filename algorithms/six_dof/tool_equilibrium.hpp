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

/// Largest residual of the optimality conditions at which a pose counts as an equilibrium [N]. The rounding error is
/// about 1e-13 N, for forces of some newtons and 20 000 N/m times positions of 10 mm.
inline constexpr double kSolved = 1e-9;

/// The pose of a tool with the smallest energy of its springs (PoseSprings) among the poses in which no shell point is
/// inside the tool:
///
///   minimise E(x, theta)   subject to   g_i(x, theta) >= 0 for all points,
///
/// with the signed distance g_i [m] of point i to the tool. The search starts at a given pose and descends to a local
/// minimum by sequential quadratic programs. Each pass linearises the constraints near the tool,
///
///   -g_i + <m_i, dx> + <r_i x m_i, dtheta> <= 0,
///   m_i: outward normal of the tool at the point nearest to point i,   r_i: from the force point to point i,
///
/// and adds the second derivatives of the constraints that hold the tool to the second derivatives of the energy, so
/// that the passes converge quadratically. A pass moves no point of the tool by more than margin(). If the second
/// derivatives at a stationary pose show a descent, such as for a cylinder balanced on one row of points, the search
/// leaves the pose along this descent. If it cannot leave the pose, the outcome is not `solved`.
///
/// Unlike the constraints of the translating proxy, these constraints come only from the points, without the flat
/// patches around the points. An edge of the tool may therefore sink in between points, by 2.5 um for a radius of 0.5
/// mm and points 0.1 mm apart.
///
/// Allocates in the constructor only.
class ToolEquilibrium {
 public:
  /// `force_point`: distance [m] from the tip centre to the force point, backwards along the axis. Shell and tool must
  /// outlive the object.
  ToolEquilibrium(const PointShell& shell, const ToolShape& tool, double force_point, Skips skips);

  /// Result of a search. `residual` [N] is the largest of these values: the unbalanced force on the tool; the
  /// unbalanced moments on tool and handle, divided by the reach of the tool; K times the largest violation of a
  /// constraint; and lambda_i |g_i| of each point that holds the tool, divided by the margin.
  struct Outcome {
    bool solved = false;    ///< the residual is at most kSolved, and the second derivatives show a minimum
    bool feasible = false;  ///< the constraints of the last pass do not contradict each other
    double residual = 0.0;  ///< [N]
    double moved = 0.0;     ///< upper bound of the distance that any point of the tool has moved [m]
    int passes = 0;
  };
  /// Moves `pose` to the equilibrium. If the outcome is not `solved`, `pose` is the pose of the last pass.
  /// `max_passes`: maximum number of passes.
  Outcome solve(const PoseSprings& springs, CoupledPose& pose, int max_passes) noexcept;

  /// A point that holds the tool: it exerts a force of magnitude `load` [N] on the tool, along -normal.
  struct Holding {
    std::uint32_t index;
    Vec3 point, surface_normal;
    Vec3 normal;         ///< m_i
    double depth, load;  ///< -g_i [m], lambda_i [N]
    Vec6 row;            ///< (m_i, r_i x m_i)
  };
  /// Returns the points that hold the tool after the last pass; at most six.
  std::span<const Holding> holding() const noexcept { return {holding_.data(), holding_count_}; }
  /// Returns tip centre, axis and roll of a tool with this force point [m] and orientation; the roll is 0 for a solid
  /// of revolution.
  ToolPose tool_pose(const Vec3& position, const Eigen::Quaterniond& orientation) const noexcept;
  /// Returns the largest distance [m] that a pass may move a point of the tool.
  double margin() const noexcept { return margin_; }
  std::size_t capacity() const noexcept { return near_->capacity(); }
  /// Returns the largest depth of a point inside the tool at the pose of the last pass [m]; 0 if no point is inside.
  double deepest() const noexcept { return deepest_; }
  /// Sets the largest depth [m] in the constraints of a pass, so that points inside the tool leave it slowly. If a
  /// point is deeper than `depth`, one factor scales all positive depths, so that the largest depth becomes `depth`. A
  /// search ends after a pass with scaled depths. If `depth` is finite, it also ends after a pass whose constraints no
  /// pose satisfies. `depth` is infinite by default.
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
  ContactBuffer contacts_;  ///< constraints of the points near the tool
  ContactBuffer probe_;     ///< constraints of the holding points at nearby poses, for second derivatives
  std::vector<Vec6> rows_, scaled_rows_;
  std::vector<double> scaled_depths_, scales_;
  std::array<Holding, 6> holding_;
  std::size_t holding_count_ = 0;
  bool feasible_ = true;
  bool leaving_ = false;  ///< true if the depths of the last pass were reduced
};

}  // namespace hapbench::six_dof
