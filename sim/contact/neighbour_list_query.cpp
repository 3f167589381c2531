#include "sim/contact/neighbour_list_query.hpp"

#include <algorithm>

#include "sim/contact/push_hits.hpp"

namespace hapbench {

namespace {

/// Skin in half widths of the tool. A thicker skin makes every step test more points, a thinner one makes more lists.
constexpr double kSkinPerHalfWidth = 0.2;
/// Maximum number of doublings of an empty skin while the tool is in free air.
constexpr int kMostDoublings = 12;
/// Relative slack, far above the rounding of the tool's motion and of the search.
constexpr double kSlack = 1e-9;

/// Upper bound of the coordinates [m] of a tool with points of the shell within twice its reach; a tool further away
/// has no points to list.
double largest_scale(const PointShell& shell, const ToolShape& tool) {
  const Box& box = shell.bounds();
  return std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()) + 4.0 * tool.reach();
}

}  // namespace

NeighbourListQuery::NeighbourListQuery(const PointShell& shell, const ToolShape& tool)
    : shell_(&shell),
      tool_(&tool),
      skin_wanted_(kSkinPerHalfWidth * tool.half_width()),
      capacity_(most_points_in(shell, tool.cover(margin_of(skin_wanted_, largest_scale(shell, tool))))),
      grid_(shell),
      scan_(grid_),
      list_(simd::padded(capacity_) + simd::lanes) {}

void NeighbourListQuery::reset() noexcept {
  work_ = {};
  has_list_ = false;
}

void NeighbourListQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  // The comparison fails for a pose that is not finite, which then makes a new list.
  const bool list_holds = has_list_ && tool_->moved_at_most(list_pose_, pose) * (1.0 + kSlack) <= skin_;
  if (!list_holds) rebuild(pose);
  if (list_size_ > 0) {
    test_list(pose, contacts);
  } else if (list_holds) {
    ++work_.skipped;
  }
}

void NeighbourListQuery::rebuild(const ToolPose& pose) noexcept {
  ++work_.lists_rebuilt;
  has_list_ = true;
  list_pose_ = pose;
  skin_ = skin_wanted_;
  collect(pose, skin_);
  if (list_size_ > 0) return;
  for (int i = 0; i < kMostDoublings && is_empty(pose, 2.0 * skin_); ++i) skin_ *= 2.0;
}

/// Search margin [m] that covers rounding, so that no point within the skin is lost; `scale` is the largest coordinate.
double NeighbourListQuery::margin_of(double skin, double scale) const noexcept {
  return skin + kSlack * (skin + tool_->reach()) + 1e-12 * scale;
}

/// Marks the points within `skin` of the tool, and some just beyond.
void NeighbourListQuery::mark_near(const ToolPose& pose, double skin) noexcept {
  const double margin = margin_of(skin, pose.position.cwiseAbs().maxCoeff() + tool_->reach());
  work_.points_tested += scan_.select(tool_->box_near(pose, margin, grid_.bounds()));
  tool_->mark_near(pose, margin, scan_.points(), scan_.packs(), scan_.marks());
}

bool NeighbourListQuery::is_empty(const ToolPose& pose, double skin) noexcept {
  mark_near(pose, skin);
  return !scan_.any_hit();
}

/// Fills the list with the points within `skin` of the tool, and some just beyond.
void NeighbourListQuery::collect(const ToolPose& pose, double skin) noexcept {
  mark_near(pose, skin);
  grid_.keeps_order() ? take_marked() : take_marked_sorted();
  for (std::size_t k = list_size_; k < simd::padded(list_size_); ++k)
    list_.x[k] = list_.y[k] = list_.z[k] = PointShell::kFarAway;
}

/// Takes whole packs at a time. Precondition: the grid keeps the shell's order.
void NeighbourListQuery::take_marked() noexcept {
  const PointColumns points{grid_.shell_indices(), shell_->x(),  shell_->y(), shell_->z(),
                            shell_->nx(),          shell_->ny(), shell_->nz()};
  list_size_ = 0;
  scan_.for_each_hit(
      [&, this](std::uint8_t hits, std::size_t i) { list_size_ += copy_hits(hits, points, i, list_, list_size_); });
}

void NeighbourListQuery::take_marked_sorted() noexcept {
  list_size_ = scan_.list_hits(list_.index.data());
  for (std::size_t k = 0; k < list_size_; ++k) {
    const auto [position, normal] = shell_->point(list_.index[k]);
    list_.set(k, position, normal);
  }
}

void NeighbourListQuery::test_list(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const PointColumns points{list_.index.data(), list_.x.data(),  list_.y.data(), list_.z.data(),
                            list_.nx.data(),    list_.ny.data(), list_.nz.data()};
  const PackRange all{0, simd::padded(list_size_) / simd::lanes};
  tool_->push_inside(pose, points, {&all, 1}, contacts);
  work_.points_tested += list_size_;
}

}  // namespace hapbench
