#pragma once

#include "sim/contact/contact_query.hpp"
#include "sim/contact/grid_scan.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The contact search of a run: a list of the points within a skin around the tool, taken from a uniform grid and used
/// until the tool has moved or turned further than the skin. Its answers are those of ShellQuery, point by point and
/// bit by bit.
///
/// Why nothing is lost. Every point of the tool lies within ToolShape::moved_at_most of where the tool was when the
/// list was made, so a shell point the tool touches is in the list as long as that is no more than the skin. The list
/// is made anew when that fails, so the slow loop of thesis 2.2 only skips work here and never misses a point.
///
/// Clearance. When a search finds no point near, it looks in ever larger skins, and the largest empty one tells how far
/// the tool may go before anything has to be searched again: in free air a step costs one comparison.
class NeighbourListQuery final : public ContactQuery {
 public:
  /// Shell and tool must outlive the query. Builds the grid: O(n).
  NeighbourListQuery(const PointShell& shell, const ToolShape& tool);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }
  void reset() noexcept override;

 private:
  void rebuild(const ToolPose& pose) noexcept;
  double margin_of(double skin, double scale) const noexcept;
  void mark_near(const ToolPose& pose, double skin) noexcept;
  bool is_empty(const ToolPose& pose, double skin) noexcept;
  void collect(const ToolPose& pose, double skin) noexcept;
  void take_marked() noexcept;
  void take_marked_sorted() noexcept;
  void test_list(const ToolPose& pose, ContactBuffer& contacts) noexcept;

  const PointShell* shell_;
  const ToolShape* tool_;
  double skin_wanted_;  ///< [m]
  std::size_t capacity_;
  GridIndex grid_;
  GridScan scan_;

  // The list: its pose, how far it reaches, and its points in ascending shell index, padded to whole packs.
  bool has_list_ = false;
  ToolPose list_pose_;
  double skin_ = 0.0;
  std::size_t list_size_ = 0;
  /// Has room for whole packs and one more: points are written by packs wherever the last one ended.
  struct List {
    explicit List(std::size_t room);
    std::vector<std::uint32_t> index;
    AlignedDoubles x, y, z, nx, ny, nz;
  };
  List list_;
};

}  // namespace hapbench
