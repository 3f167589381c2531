#include <Eigen/Geometry>
#include <algorithm>

#include "algorithms/laws/laws.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kOriginalAveragingInfo = {
    .name = "original_averaging",
    .summary = "the trainer's original algorithm (DP): depths summed, gradients averaged",
    .formula =
        "u_r = sum u_i / |sum u_i|, d_r = sum d_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T; "
        "zero force when |sum u_i| <= 1e-9 n",
    .source = "thesis B.2, Eq. B.1; always with depth model shortest_distance and without reduction",
    .known_failure = "opposite gradients make d_r explode and u_r flip by 180 degrees (thesis B.3.3): vibration",
    .parameters = kParameters,
};

namespace {

/// Below this mean gradient the direction is rounding noise.
constexpr double kCancelledBelow = 1e-9;

class OriginalAveraging final : public ForceLaw {
 public:
  explicit OriginalAveraging(double stiffness) : ForceLaw(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    simd::Pack depths(0.0);
    for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) depths += simd::load(&contacts.depth[i]);
    const Vec3 gradients = gradient_sum(contacts);
    const double length = gradients.norm();
    if (length <= kCancelledBelow * static_cast<double>(contacts.size())) return {};
    const Vec3 u = gradients / length;
    return {-K_ * (simd::sum(depths) / length) * u, u * u.transpose()};
  }

  /// One spring, compressed by d_r. The law gives it no point of application; the middle of the contacts is taken.
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    if (K_ == 0.0) return {};
    return {spring.squaredNorm() / (2.0 * K_), mean_arm(contacts, tip).cross(spring)};
  }

  /// The velocity at that point of application, along u_r.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return S * tool.angular_velocity.cross(mean_arm(contacts, tool.pose.position));
  }
};

/// sum d_i / |sum u_i|, where |sum u_i| > kCancelledBelow n, or the force is zero.
double bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e9 * std::min(1.0, static_cast<double>(n)) * depth;
}

/// S = u_r u_r^T, and the mean gradient u_r points straight in.
WedgeStiffness wedge(const RenderingConfig&, double, double) {
  return {1.0, 0.0};
}

}  // namespace

const AlgorithmTheory kOriginalAveragingTheory = {.force_bound = bound, .wedge_stiffness = wedge};

std::unique_ptr<ForceLaw> make_original_averaging(const RenderingConfig& config) {
  return std::make_unique<OriginalAveraging>(config.stiffness);
}

}  // namespace hapbench
