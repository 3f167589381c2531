#pragma once

#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench {

/// The margin in half widths of the tool. Wider, and each pass looks at more points; narrower, and a fast tool takes
/// more passes.
inline constexpr double kProxyMargin = 0.2;

/// What keeps a proxy of the tool out of an environment, as linear constraints on its next move x: d_i + <u_i, x> <= 0
/// with depth d_i and gradient u_i of contact i.
class ProxyConstraints {
 public:
  virtual ~ProxyConstraints() = default;

  /// Replaces the contents of `contacts` by the constraints on a proxy at a pose that wants to move by `wanted`;
  /// padded. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept = 0;
  virtual std::size_t capacity() const noexcept = 0;
  /// How far the proxy may move before it has to ask again [m].
  virtual double margin() const noexcept = 0;
  /// True when a constraint's force acts at its contact's point; false when it acts at the tip, which does not move
  /// when the tool turns.
  virtual bool act_at_points() const noexcept = 0;
  virtual void reset() noexcept = 0;
  virtual const SearchWork& work() const noexcept = 0;
};

/// The points of a shell within the margin of the tool (ToolShape::surface_constraints) and the patches of surface
/// about them (add_edge_constraints).
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
  double spacing_;          ///< of the shell [m]
  ToolShape::Grown reach_;  ///< what the tool could touch within the margin
  std::unique_ptr<ContactQuery> near_;
  AlignedDoubles places_x_, places_y_, places_z_;  ///< scratch memory of add_edge_constraints
};

/// The springs that the tool could compress: planes, which hold at any distance. A bilateral spring holds the tool from
/// both sides, so it gives the pair (d, u) and (-d, -u).
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

}  // namespace hapbench
