#pragma once

#include <cstdint>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/contact/grid_index.hpp"

namespace hapbench {

/// The contact search of a run: a list of the points within a skin around the tool, taken from a uniform grid and used
/// until the tool has moved or turned further than the skin. The answers are those of ShellQuery, bit by bit.
///
/// Why no point is missed: every point of the tool lies within ToolShape::moved_at_most of where it was when the list
/// was made, so a shell point that the tool touches is in the list as long as that is at most the skin, beyond which
/// the list is made anew. The slow loop of thesis 2.2 thus only saves work here.
///
/// Clearance: if a search finds no point near, it looks in ever larger skins. The largest empty one tells how far the
/// tool may go before the next search: in free air a step costs one comparison.
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
  template <class Take>
  void for_each_hit(const Take& take) const;
  void take_marked() noexcept;

  const PointShell* shell_;
  const ToolShape* tool_;
  double skin_wanted_;  ///< [m]
  std::size_t capacity_;
  GridIndex grid_;
  std::vector<PackRange> runs_;      ///< of the grid's points near the tool
  std::vector<std::uint8_t> marks_;  ///< of the packs of the runs

  // The list: its pose, how far it reaches, and its points in ascending shell index, padded to whole packs.
  bool has_list_ = false;
  ToolPose list_pose_;
  double skin_ = 0.0;
  std::size_t list_size_ = 0;
  /// Has room for one pack more, because searches write whole packs behind the last point.
  struct List : ShellColumns {
    explicit List(std::size_t room) : ShellColumns(room), index(room) {}
    std::vector<std::uint32_t> index;
  };
  List list_;
};

}  // namespace hapbench
