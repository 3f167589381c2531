#include "sim/contact/neighbour_list_query.hpp"

#include <algorithm>
#include <bit>

#include "sim/contact/most_points.hpp"
#include "sim/contact/push_hits.hpp"

namespace hapbench {
namespace {

/// Skin in half widths of the tool: thicker, and every step tests more points; thinner, and lists are made more often.
constexpr double kSkinPerHalfWidth = 0.2;
/// How often an empty skin is doubled when the tool is in free air.
constexpr int kMostDoublings = 12;
/// Relative slack for the rounding of how far the tool has moved and of the search itself, far above both.
constexpr double kSlack = 1e-9;

/// The largest coordinate of a tool that has points of the shell within twice its reach; one further away has none to
/// list.
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

NeighbourListQuery::List::List(std::size_t room)
    : index(room), x(room), y(room), z(room), nx(room), ny(room), nz(room) {}

void NeighbourListQuery::reset() noexcept {
  work_ = {};
  has_list_ = false;
}

void NeighbourListQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  // Written so that a pose that is not finite asks for a new list instead of trusting the old one.
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

/// How far a search must look so that rounding loses no point within the skin; `scale` is the largest coordinate.
double NeighbourListQuery::margin_of(double skin, double scale) const noexcept {
  return skin + kSlack * (skin + tool_->reach()) + 1e-12 * scale;
}

/// Marks the points within `skin` of the tool (and some just beyond).
void NeighbourListQuery::mark_near(const ToolPose& pose, double skin) noexcept {
  const double margin = margin_of(skin, pose.position.cwiseAbs().maxCoeff() + tool_->reach());
  work_.points_tested += scan_.select(tool_->box_near(pose, margin, grid_.bounds()));
  tool_->mark_near(pose, margin, scan_.points(), scan_.packs(), scan_.marks());
}

bool NeighbourListQuery::is_empty(const ToolPose& pose, double skin) noexcept {
  mark_near(pose, skin);
  return !scan_.any_hit();
}

/// Fills the list with the points within `skin` of the tool (and some just beyond).
void NeighbourListQuery::collect(const ToolPose& pose, double skin) noexcept {
  mark_near(pose, skin);
  if (grid_.keeps_order()) {
    take_marked();
  } else {
    take_marked_sorted();
  }
  for (std::size_t k = list_size_; k < simd::padded(list_size_); ++k)
    list_.x[k] = list_.y[k] = list_.z[k] = PointShell::kFarAway;
}

/// The grid's order is the shell's: whole packs at a time.
void NeighbourListQuery::take_marked() noexcept {
  const PointColumns points{grid_.shell_indices(), shell_->x(),  shell_->y(), shell_->z(),
                            shell_->nx(),          shell_->ny(), shell_->nz()};
  list_size_ = 0;
  scan_.for_each_hit(
      [&, this](std::uint8_t hits, std::size_t i) { list_size_ += copy_hits(hits, points, i, list_, list_size_); });
}

void NeighbourListQuery::take_marked_sorted() noexcept {
  list_size_ = 0;
  scan_.for_each_hit([this](std::uint8_t hits, std::size_t i) {
    for (; hits != 0; hits &= static_cast<std::uint8_t>(hits - 1)) {
      list_.index[list_size_++] = grid_.shell_index(i + static_cast<std::size_t>(std::countr_zero(hits)));
    }
  });
  std::sort(list_.index.begin(), list_.index.begin() + static_cast<std::ptrdiff_t>(list_size_));
  for (std::size_t k = 0; k < list_size_; ++k) {
    const std::uint32_t i = list_.index[k];
    list_.x[k] = shell_->x()[i];
    list_.y[k] = shell_->y()[i];
    list_.z[k] = shell_->z()[i];
    list_.nx[k] = shell_->nx()[i];
    list_.ny[k] = shell_->ny()[i];
    list_.nz[k] = shell_->nz()[i];
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
