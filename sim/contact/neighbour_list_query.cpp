#include "sim/contact/neighbour_list_query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact/margin_query.hpp"
#include "sim/contact/push_hits.hpp"
#include "sim/contact/shell_query.hpp"
#include "sim/contact/tool_box.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {
namespace {

/// Skin in tool radii: thicker, and every step tests more points; thinner, and lists are made more often.
constexpr double kSkinPerRadius = 0.2;
/// How often an empty skin is doubled when the tool is in free air.
constexpr int kMostDoublings = 12;
/// Relative slack for the rounding of `moved` and of the search itself, far above both.
constexpr double kSlack = 1e-9;

}  // namespace

NeighbourListQuery::NeighbourListQuery(const PointShell& shell, const Tool& tool)
    : shell_(&shell),
      tool_(tool),
      radius2_(largest_square_within(tool.radius)),
      reach_(std::hypot(tool.length, tool.radius)),
      grid_(shell),
      index_(shell.padded_size()),
      x_(shell.padded_size()),
      y_(shell.padded_size()),
      z_(shell.padded_size()),
      nx_(shell.padded_size()),
      ny_(shell.padded_size()),
      nz_(shell.padded_size()) {}

void NeighbourListQuery::reset() noexcept {
  work_ = {};
  has_list_ = false;
}

std::unique_ptr<ContactQuery> NeighbourListQuery::with_margin(double margin) const {
  return std::make_unique<MarginQuery>(std::make_unique<NeighbourListQuery>(*shell_, grown(tool_, margin)), tool_,
                                       margin);
}

void NeighbourListQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  // Written so that a pose that is not finite asks for a new list instead of trusting the old one.
  const bool list_holds = has_list_ && moved_since_list(pose) <= skin_;
  if (!list_holds) rebuild(pose);
  if (list_holds && list_size_ == 0) ++work_.skipped;
  test_list(pose, contacts);
}

double NeighbourListQuery::moved_since_list(const ToolPose& pose) const noexcept {
  const double moved = (pose.position - list_pose_.position).norm() + (pose.axis - list_pose_.axis).norm() * reach_;
  return moved * (1.0 + kSlack);
}

void NeighbourListQuery::rebuild(const ToolPose& pose) noexcept {
  ++work_.lists_rebuilt;
  has_list_ = true;
  list_pose_ = pose;
  skin_ = kSkinPerRadius * tool_.radius;
  collect(pose, skin_);
  for (int i = 0; i < kMostDoublings && list_size_ == 0; ++i) {
    collect(pose, 2.0 * skin_);
    if (list_size_ == 0) skin_ *= 2.0;
  }
  // The last search looked twice as far and found points; within the skin there is none.
  if (skin_ > kSkinPerRadius * tool_.radius) list_size_ = 0;
}

/// Fills the list with the points within `skin` of the tool (and some just beyond, round a flat tool's edges).
void NeighbourListQuery::collect(const ToolPose& pose, double skin) noexcept {
  using simd::Pack;
  const double scale = pose.position.cwiseAbs().maxCoeff() + reach_;
  const double margin = skin + kSlack * (skin + reach_) + 1e-12 * scale;
  const double radius = tool_.radius + margin;
  const Pack radius2(radius * radius), low(-tool_.length - margin);
  const Pack high(tool_.tip == Tip::round ? radius : margin);
  list_size_ = 0;
  grid_.for_each_run(box_around(tool_, pose, margin, grid_.bounds()), [&](std::uint32_t first, std::uint32_t last) {
    // Whole packs, so the first and last one may reach into neighbouring columns: those lanes are passed over.
    for (std::size_t i = first / simd::lanes * simd::lanes; i < last; i += simd::lanes) {
      const AxialPack q(pose, grid_.x() + i, grid_.y() + i, grid_.z() + i);
      const simd::Mask near = q.s <= high && q.s >= low && q.rho2 <= radius2;
      if (!simd::any(near)) continue;
      for (std::size_t lane = 0; lane < simd::lanes; ++lane) {
        if (i + lane >= first && i + lane < last && simd::lane(near, lane)) {
          index_[list_size_++] = grid_.shell_index(i + lane);
        }
      }
    }
    work_.points_tested += last - first;
  });
  if (!grid_.keeps_order()) std::sort(index_.begin(), index_.begin() + static_cast<std::ptrdiff_t>(list_size_));
  for (std::size_t k = 0; k < list_size_; ++k) {
    x_[k] = shell_->x()[index_[k]];
    y_[k] = shell_->y()[index_[k]];
    z_[k] = shell_->z()[index_[k]];
    nx_[k] = shell_->nx()[index_[k]];
    ny_[k] = shell_->ny()[index_[k]];
    nz_[k] = shell_->nz()[index_[k]];
  }
  for (std::size_t k = list_size_; k < simd::padded(list_size_); ++k) x_[k] = y_[k] = z_[k] = PointShell::kFarAway;
}

void NeighbourListQuery::test_list(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const ToolTest touches(tool_, radius2_);
  const PointColumns points{index_.data(), x_.data(), y_.data(), z_.data(), nx_.data(), ny_.data(), nz_.data()};
  for (std::size_t k = 0; k < list_size_; k += simd::lanes) {
    const simd::Mask hit = touches(AxialPack(pose, &x_[k], &y_[k], &z_[k]));
    if (simd::any(hit)) push_hits(hit, points, k, contacts);
  }
  work_.points_tested += list_size_;
}

}  // namespace hapbench
