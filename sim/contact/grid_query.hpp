#pragma once

#include "sim/contact/contact_query.hpp"
#include "sim/contact/grid_scan.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Compares the points of the grid cells around the tool with the tool, anew at each pose: the neighbour list's search
/// without its list. What it costs does not depend on how the tool moves, so it has the best worst case. Its answers
/// are those of ShellQuery, point by point and bit by bit. Cost O(points in the box around the tool).
class GridQuery final : public ContactQuery {
 public:
  /// Shell and tool must outlive the query. Builds the grid: O(n).
  GridQuery(const PointShell& shell, const ToolShape& tool);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return shell_->size(); }
  void reset() noexcept override { work_ = {}; }

 private:
  void push_sorted(const ToolPose& pose, ContactBuffer& contacts) noexcept;

  const PointShell* shell_;
  const ToolShape* tool_;
  GridIndex grid_;
  GridScan scan_;
  std::vector<std::uint32_t> found_;  ///< shell indices of the colliding points, when they have to be sorted
};

}  // namespace hapbench
