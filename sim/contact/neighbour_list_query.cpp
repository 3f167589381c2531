#include "sim/contact/neighbour_list_query.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "sim/core/simd.hpp"
#include "sim/geometry/grid_index.hpp"

namespace hapbench {
namespace {

/// Thickness of the skin (the layer around the tool whose points are listed), in units of the tool's half width. With a
/// thicker skin every step tests more points. With a thinner skin lists must be rebuilt more often.
constexpr double kSkinPerHalfWidth = 0.2;
/// Maximum number of times that a skin without points is doubled.
constexpr int kMaxDoublings = 12;
/// Relative slack that covers rounding in the tool's motion and in the search.
constexpr double kSlack = 1e-9;

/// Returns an upper bound of the absolute values of the coordinates [m] of any tool point, for a tool that has shell
/// points within twice its reach. If the tool is farther away from the shell, the list is empty.
double largest_scale(const PointShell& shell, const ToolShape& tool) {
  const Box& box = shell.bounds();
  return std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()) + 4.0 * tool.reach();
}

/// The contact search of a run, with Verlet neighbour lists. The skin is the layer around the tool up to a given
/// distance from its surface. The search lists the shell points in the tool and in its skin, and tests only the listed
/// points. The points come from a uniform grid. The contacts are bitwise identical to the contacts of ShellQuery.
///
/// No contact is missed: since the list was built, no point of the tool has moved farther than
/// ToolShape::displacement_bound [m], which covers translation and rotation. While this bound is at most the thickness
/// of the skin, every shell point that touches the tool is in the list. When the bound exceeds the thickness, the list
/// is rebuilt. The list therefore saves work but does not change the result. In section 2.2 of the thesis, a slow loop
/// that searches the contacts has the role of the list.
///
/// In free air, the list is empty. The thickness of the skin is then doubled as long as the doubled skin contains no
/// point, at most kMaxDoublings times. Until the tool has moved by this thickness, a step costs one comparison.
class NeighbourListQuery final : public ContactQuery {
 public:
  /// O(n) for the first search in a shell; later searches share its grid (PointShell::grid).
  NeighbourListQuery(const PointShell& shell, const ToolShape& tool)
      : shell_(&shell),
        tool_(&tool),
        normal_skin_(kSkinPerHalfWidth * tool.half_width()),
        capacity_(max_points_in(shell, tool.cover(margin_of(normal_skin_, largest_scale(shell, tool))))),
        grid_(shell.grid()),
        // A contiguous range of n points overlaps with at most n / 8 + 2 SIMD packs of eight points.
        marks_(shell.size() / simd::lanes + 2 * grid_.columns()),
        list_(simd::padded(capacity_) + simd::lanes) {
    runs_.reserve(grid_.columns());
  }

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    ++work_.queries;
    contacts.clear();

    // Rebuild the list if the tool may have moved out of the skin. The comparison is false for a pose that is
    // not finite.
    const bool list_holds = has_list_ && tool_->displacement_bound(list_pose_, pose) * (1.0 + kSlack) <= skin_;
    if (!list_holds) rebuild(pose);

    // Test the listed points. An empty list that is still valid proves that there are no contacts.
    if (list_size_ > 0) {
      const PointColumns points{list_.index.data(), list_.x.data(),  list_.y.data(), list_.z.data(),
                                list_.nx.data(),    list_.ny.data(), list_.nz.data()};
      tool_->push_inside(pose, points, simd::padded(list_size_) / simd::lanes, contacts);
      work_.points_tested += list_size_;
    } else if (list_holds) {
      ++work_.skipped;
    }
  }
  std::size_t capacity() const noexcept override { return capacity_; }
  void reset() noexcept override {
    work_ = {};
    has_list_ = false;
  }

 private:
  void rebuild(const ToolPose& pose) noexcept {
    ++work_.lists_rebuilt;
    has_list_ = true;
    list_pose_ = pose;

    // List the points within the skin before any doubling.
    skin_ = normal_skin_;
    mark_near(pose, skin_);
    take_marked();

    // In free air, double the skin as long as it is empty.
    bool is_empty = list_size_ == 0;
    for (int i = 0; i < kMaxDoublings && is_empty; ++i) {
      mark_near(pose, 2.0 * skin_);
      for_each_hit([&](std::uint8_t, std::size_t) { is_empty = false; });
      if (is_empty) skin_ *= 2.0;
    }
  }

  /// Returns the search margin [m] for a skin of the thickness `skin` [m]. The margin covers rounding, so that no point
  /// within the skin is missed. `scale`: upper bound of the absolute values of the tool's coordinates [m].
  double margin_of(double skin, double scale) const noexcept {
    return skin + kSlack * (skin + tool_->reach()) + 1e-12 * scale;
  }

  /// Marks the points within `skin` [m] of the tool in `marks_`, and some points slightly farther away.
  void mark_near(const ToolPose& pose, double skin) noexcept {
    const double margin = margin_of(skin, pose.position.cwiseAbs().maxCoeff() + tool_->reach());
    runs_.clear();
    grid_.for_each_run(
        tool_->box_near(pose, margin, shell_->bounds()), [this](std::uint32_t first, std::uint32_t last) {
          const std::size_t end = (last + simd::lanes - 1) / simd::lanes;
          // The first and the last pack may contain points of neighbouring columns, which are masked out.
          runs_.push_back({first / simd::lanes, end, static_cast<std::uint8_t>(0xffu << first % simd::lanes),
                           static_cast<std::uint8_t>(0xffu >> (end * simd::lanes - last))});
          work_.points_tested += last - first;
        });
    tool_->mark_near(pose, margin, {grid_.x(), grid_.y(), grid_.z()}, runs_, marks_.data());
  }

  /// Calls `take(hits, i)` for each pack that has marked points, in the order of the grid. Bit k of `hits` is set if
  /// point i + k is marked.
  template <class Take>
  void for_each_hit(const Take& take) const {
    const std::uint8_t* marks = marks_.data();
    for (const PackRange& run : runs_) {
      for (std::size_t pack = run.first; pack < run.last; ++pack) {
        if (const std::uint8_t hits = *marks++; hits != 0) take(hits, pack * simd::lanes);
      }
    }
  }

  /// Fills the list with the marked points, in ascending shell index.
  void take_marked() noexcept {
    list_size_ = 0;
    if (grid_.keeps_order()) {
      // Copy whole packs at a time.
      const PointColumns points{grid_.shell_indices(), shell_->x(),  shell_->y(), shell_->z(),
                                shell_->nx(),          shell_->ny(), shell_->nz()};
      for_each_hit([&, this](std::uint8_t hits, std::size_t i) {
        list_size_ += simd::copy_selected(hits, points, i, list_, list_size_);
      });
    } else {
      for_each_hit([this](std::uint8_t hits, std::size_t i) {
        for (unsigned rest = hits; rest != 0; rest &= rest - 1)
          list_.index[list_size_++] = grid_.shell_indices()[i + static_cast<std::size_t>(std::countr_zero(rest))];
      });
      std::sort(list_.index.begin(), list_.index.begin() + static_cast<std::ptrdiff_t>(list_size_));
      for (std::size_t k = 0; k < list_size_; ++k) {
        const auto [position, normal] = shell_->point(list_.index[k]);
        list_.set(k, position, normal);
      }
    }
    for (std::size_t k = list_size_; k < simd::padded(list_size_); ++k)
      list_.x[k] = list_.y[k] = list_.z[k] = PointShell::kFarAway;
  }

  const PointShell* shell_;
  const ToolShape* tool_;
  double normal_skin_;  ///< thickness of the skin before any doubling [m]
  std::size_t capacity_;
  const GridIndex& grid_;
  std::vector<PackRange> runs_;      ///< ranges of the grid's points near the tool
  std::vector<std::uint8_t> marks_;  ///< one byte for each pack of the ranges, one bit for each point

  // The list: the tool's pose when it was built, its skin [m], and its points in ascending shell index, padded
  // to whole packs.
  bool has_list_ = false;
  ToolPose list_pose_;
  double skin_ = 0.0;
  std::size_t list_size_ = 0;
  /// Columns of the listed points and their shell indices, with one extra pack because searches write whole
  /// packs behind the last point.
  struct List : ShellColumns {
    explicit List(std::size_t room) : ShellColumns(room), index(room) {}
    std::vector<std::uint32_t> index;
  };
  List list_;
};

}  // namespace

std::size_t max_points_in(const PointShell& shell, const ToolShape::Cover& cover) {
  return std::min(shell.size(), cover.balls * shell.max_points_in_ball(cover.radius));
}

std::unique_ptr<ContactQuery> make_neighbour_list_query(const PointShell& shell, const ToolShape& tool) {
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

}  // namespace hapbench
