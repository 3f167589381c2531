#include <Eigen/Geometry>
#include <algorithm>

#include "algorithms/laws/laws.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kHighestDepthInfo = {
    .name = "highest_depth",
    .summary = "one spring, as deep as the deepest contact, along the averaged gradient",
    .formula =
        "u_r = sum u_i / |sum u_i|, d_r = max d_i, f = -K d_r u_r, S = u_r u_r^T; zero force when "
        "|sum u_i| <= 1e-9 n; always without reduction",
    .source = "thesis 4.1, which says of it (its reference 3) that it vibrates in a hole",
    .known_failure =
        "u_r turns round by 180 degrees as one of nearly opposite contacts comes or goes, and d_r jumps from contact "
        "to contact: the force jumps by up to 2 K d_r",
    .parameters = kParameters,
};

namespace {

/// Below this mean gradient the direction is rounding noise.
constexpr double kCancelledBelow = 1e-9;

class HighestDepth final : public ForceLaw {
 public:
  explicit HighestDepth(double stiffness) : ForceLaw(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Vec3 gradients = gradient_sum(contacts);
    const double length = gradients.norm();
    if (length <= kCancelledBelow * static_cast<double>(contacts.size())) return {};
    const auto depths = contacts.depth.begin();
    const double deepest = *std::max_element(depths, depths + static_cast<std::ptrdiff_t>(contacts.size()));
    const Vec3 u = gradients / length;
    return {-K_ * deepest * u, u * u.transpose()};
  }

  /// One spring, compressed by d_r. As in original_averaging it acts in the middle of the contacts.
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    if (K_ == 0.0) return {};
    return {spring.squaredNorm() / (2.0 * K_), mean_arm(contacts, tip).cross(spring)};
  }

  /// The velocity at that point of attack, along u_r.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return S * tool.angular_velocity.cross(mean_arm(contacts, tool.pose.position));
  }
};

/// d_r is one of the depths and u_r a unit vector.
double bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min(1.0, static_cast<double>(n)) * depth;
}

/// S = u_r u_r^T, and the mean gradient u_r points straight in.
WedgeStiffness wedge(const RenderingConfig&, double, double) {
  return {1.0, 0.0};
}

}  // namespace

const AlgorithmTheory kHighestDepthTheory = {.force_bound = bound, .wedge_stiffness = wedge};

std::unique_ptr<ForceLaw> make_highest_depth(const RenderingConfig& config) {
  return std::make_unique<HighestDepth>(config.stiffness);
}

}  // namespace hapbench
