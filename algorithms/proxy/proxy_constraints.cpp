#include "algorithms/proxy/proxy_constraints.hpp"

#include <limits>

#include "algorithms/proxy/edge_constraints.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench {
namespace {

/// The search looks a little further than the proxy moves, for the rounding of both.
constexpr double kQueryMargin = 1.0 + 1e-6;
/// How far a point may lie inside one plane of an edge and still count as passing it, as a share of the spacing.
constexpr double kEdgeSlack = 1e-3;

}  // namespace

ShellConstraints::ShellConstraints(const PointShell& shell, const ToolShape& tool, Skips skips)
    : tool_(&tool),
      margin_(kProxyMargin * tool.half_width()),
      spacing_(typical_spacing(shell)),
      reach_(tool.grown(margin_ * kQueryMargin)),
      near_(make_contact_query(shell, *reach_.shape, skips)),
      places_x_(simd::padded(near_->capacity())),
      places_y_(places_x_.size()),
      places_z_(places_x_.size()) {}

void ShellConstraints::constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept {
  near_->contacts_at({proxy.position + reach_.forward * proxy.axis, proxy.axis, proxy.roll}, contacts);
  tool_->surface_constraints(proxy, wanted, kEdgeSlack * spacing_, contacts);
  add_edge_constraints(*tool_, proxy, spacing_, margin_, {places_x_.data(), places_y_.data(), places_z_.data()},
                       contacts);
}

void SpringConstraints::constraints_at(const ToolPose& proxy, const Vec3&, ContactBuffer& contacts) noexcept {
  constexpr double never = -std::numeric_limits<double>::infinity();
  contacts.clear();
  for (std::size_t j = 0; j < springs_->gradients.size(); ++j) {
    const Vec3& u = springs_->gradients[j];
    const double depth = proxy.position.dot(u);
    // A position that is not finite compresses no spring.
    if (depth > never) push_spring(j, proxy.position, depth, u, contacts);
    if (springs_->bilateral && -depth > never) push_spring(j, proxy.position, -depth, -u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

std::size_t SpringConstraints::capacity() const noexcept {
  return springs_->gradients.size() * (springs_->bilateral ? 2 : 1);
}

double SpringConstraints::margin() const noexcept {
  return std::numeric_limits<double>::infinity();
}

}  // namespace hapbench
