#include "sim/contact/shell_query.hpp"

#include <cmath>
#include <limits>

#include "sim/contact/margin_query.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {

double largest_square_within(double r) {
  constexpr double up = std::numeric_limits<double>::infinity();
  double square = r * r;
  while (std::sqrt(square) > r) square = std::nextafter(square, 0.0);
  while (std::sqrt(std::nextafter(square, up)) <= r) square = std::nextafter(square, up);
  return square;
}

ShellQuery::ShellQuery(const PointShell& shell, const Tool& tool)
    : shell_(&shell), tool_(tool), radius2_(largest_square_within(tool.radius)) {}

std::unique_ptr<ContactQuery> ShellQuery::with_margin(double margin) const {
  return std::make_unique<MarginQuery>(std::make_unique<ShellQuery>(*shell_, grown(tool_, margin)), tool_, margin);
}

void ShellQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const PointShell& shell = *shell_;
  const ToolTest touches(tool_, radius2_);

  contacts.clear();
  for (std::size_t i = 0; i < shell.padded_size(); i += simd::lanes) {
    const simd::Mask hit = touches(AxialPack(pose, shell.x() + i, shell.y() + i, shell.z() + i));
    if (!simd::any(hit)) continue;
    for (std::size_t lane = 0; lane < simd::lanes; ++lane) {
      if (!simd::lane(hit, lane)) continue;
      const SurfacePoint point = shell.point(i + lane);
      contacts.push(static_cast<std::uint32_t>(i + lane), point.position, point.normal);
    }
  }
  ++work_.queries;
  work_.points_tested += shell.size();
}

}  // namespace hapbench
