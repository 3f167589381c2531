#include "algorithms/depth/shortest_distance.hpp"

#include <cmath>

#include "sim/core/simd.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {

const ModelInfo kShortestDistanceInfo = {
    .name = "shortest_distance",
    .summary = "distance to the nearest surface of the tool, gradient towards it",
    .formula = "d = min(r - |rho|, -s, L + s), u = rho/|rho|, axis, -axis; round tip, s > 0: d = r - |x|, u = x/|x|",
    .source =
        "thesis B.1, with depths >= 0 of which the smallest wins (as printed, negative depths would pull the tool in)",
    .known_failure = "the gradient flips by 180 degrees when a point crosses the tool's median line (thesis B.3.1)",
};

namespace {

/// A radial direction shorter than this fraction of the radius is undefined.
constexpr double kUndefinedBelow = 1e-12;

class ShortestDistance final : public DepthModel {
 public:
  void evaluate(const Tool& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    shortest_distance_depths(tool, pose, contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.set_gradient(i, gradient(tool, pose, contacts, i));
    contacts.pad();
  }

 private:
  static Vec3 gradient(const Tool& tool, const ToolPose& pose, const ContactBuffer& contacts, std::size_t i) {
    // The same order of operations as AxialPack, so that "which surface is nearest" is decided on the same numbers.
    const Vec3 x = contacts.point(i) - pose.position;
    const double s = x.x() * pose.axis.x() + x.y() * pose.axis.y() + x.z() * pose.axis.z();
    const bool in_ball = tool.tip == Tip::round && s > 0.0;
    const Vec3 radial = in_ball ? x : Vec3(x - s * pose.axis);
    const double length = std::sqrt(radial.x() * radial.x() + radial.y() * radial.y() + radial.z() * radial.z());
    const double d_radial = tool.radius - length;
    if (!in_ball) {
      // Ties prefer the side, then the tip, then the bottom.
      const double d_tip = tool.tip == Tip::flat ? -s : d_radial;
      const double d_bottom = tool.length + s;
      if (d_tip < d_radial && d_tip <= d_bottom) return pose.axis;
      if (d_bottom < d_radial && d_bottom < d_tip) return -pose.axis;
    }
    return length < kUndefinedBelow * tool.radius ? Vec3(-contacts.normal(i)) : Vec3(radial / length);
  }
};

}  // namespace

void shortest_distance_depths(const Tool& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept {
  using simd::Pack;
  const Pack radius(tool.radius), length(tool.length), zero(0.0);
  const bool round = tool.tip == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack side = radius - simd::sqrt(q.rho2);
    const Pack bottom = length + q.s;
    Pack d = simd::min(side, bottom);
    d = round ? simd::select(q.s > zero, radius - simd::sqrt(q.distance2()), d) : simd::min(d, -q.s);
    simd::store(d, &contacts.depth[i]);
  }
}

std::unique_ptr<DepthModel> make_shortest_distance() {
  return std::make_unique<ShortestDistance>();
}

}  // namespace hapbench
