#pragma once

#include <memory>

#include "sim/contact/contact_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The margin in half widths of the tool. With a wider one each pass looks at more points, with a narrower one a fast
/// tool takes more passes.
inline constexpr double kProxyMargin = 0.2;

/// Keeps a proxy of the tool out of an environment by linear constraints on its next move x: d_i + <u_i, x> <= 0 with
/// depth d_i and gradient u_i of contact i.
class ProxyConstraints {
 public:
  virtual ~ProxyConstraints() = default;

  /// Replaces the contents of `contacts` by the constraints, padded, on a proxy at the pose `proxy` that wants to move
  /// by `wanted` [m]. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept = 0;
  virtual std::size_t capacity() const noexcept = 0;
  /// Distance that the proxy may move before the constraints must be computed again [m].
  virtual double margin() const noexcept = 0;
  /// True if the force of a constraint acts at the point of its contact, false if it acts at the tip, which does not
  /// move when the tool turns.
  virtual bool act_at_points() const noexcept = 0;
  virtual void reset() noexcept = 0;
  virtual const SearchWork& work() const noexcept = 0;
};

/// Constraints of the shell points within the margin of the tool (ToolShape::surface_constraints) and of the patches of
/// surface about them (add_edge_constraints).
class ShellConstraints final : public ProxyConstraints {
 public:
  /// Shell and tool must outlive the constraints.
  ShellConstraints(const PointShell& shell, const ToolShape& tool, Skips skips);

  void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return 2 * near_->capacity(); }
  double margin() const noexcept override { return margin_; }
  bool act_at_points() const noexcept override { return true; }
  void reset() noexcept override { near_->reset(); }
  const SearchWork& work() const noexcept override { return near_->work(); }

 private:
  const ToolShape* tool_;
  double margin_;
  double spacing_;          ///< typical spacing of the shell [m]
  ToolShape::Grown reach_;  ///< the tool, grown by the margin
  std::unique_ptr<ContactQuery> near_;
  AlignedDoubles places_x_, places_y_, places_z_;  ///< scratch memory for add_edge_constraints
};

/// Constraints of springs: planes, which hold at any distance. A bilateral spring holds the tool from both sides, so it
/// gives the pair (d, u) and (-d, -u).
class SpringConstraints final : public ProxyConstraints {
 public:
  /// The springs must outlive the constraints.
  explicit SpringConstraints(const SpringSet& springs) : springs_(&springs) {}

  void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override;
  double margin() const noexcept override;
  bool act_at_points() const noexcept override { return false; }
  void reset() noexcept override { work_ = {}; }
  const SearchWork& work() const noexcept override { return work_; }

 private:
  const SpringSet* springs_;
  SearchWork work_;
};

/// Typical distance from a shell point to its neighbours [m], 0 for fewer than three points. It is the median, over
/// some of the points, of the distance to the second nearest place, hence the spacing of a square lattice as well as of
/// a line. Points at the same place count as one. O(size) with about a hundred distances for each point; call it in
/// preparation.
double typical_spacing(const PointShell& shell);

/// Keeps the edges of the tool from sinking in between the points of a shell. The surface is assumed to be flat about
/// each point, as far as the next points. If the foremost place of the tool towards the surface, v_i = argmin <q, n_i>
/// over the tool, lies on that patch, it must stay above it:
///
///     <n_i, v_i + x - x_i> >= 0, appended as contact with depth <n_i, x_i - v_i> and gradient -n_i.
///
/// Without patches, the edge of a drill on a wall would find up to 0.05 mm of room between two rows of points 0.1 mm
/// apart, because it touches points with both of its faces. Patches apply at distances up to `margin` and depths up to
/// a tenth of the spacing. The tool never gets deeper, so a patch that lies further out belongs to another part of the
/// surface, such as the other side of a rim. Call after ToolShape::surface_constraints. `places` is scratch memory,
/// padded, for one place per contact. Preconditions: room for twice the contacts, and for as many places. O(n).
void add_edge_constraints(const ToolShape& tool, const ToolPose& pose, double spacing, double margin,
                          const PlaceArrays& places, ContactBuffer& contacts) noexcept;

}  // namespace hapbench
