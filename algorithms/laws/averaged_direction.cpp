#include <algorithm>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

/// original_averaging and highest_depth: one spring along the averaged gradient, u_r = sum u_i / |sum u_i|,
/// f = -K d_r u_r, S = u_r u_r^T. They differ in the depth d_r.
namespace hapbench {
namespace {

/// Below this mean gradient the direction is rounding noise, and the force is zero.
constexpr double kCancelledBelow = 1e-9;

/// The answer of one spring of stiffness K that is compressed by d_r = depth(|sum u_i|) [m]. Leaves weights of 1. The
/// laws define no point of application.
template <class Depth>
LawForce force_along_mean(ContactBuffer& contacts, double K, const Depth& depth) noexcept {
  set_weights(contacts, 1.0);
  const Vec3 gradients = gradient_sum(contacts);
  const double length = gradients.norm();
  if (length <= kCancelledBelow * static_cast<double>(contacts.size())) return {};
  const Vec3 u = gradients / length;
  return {-K * depth(length) * u, u * u.transpose()};
}

class OriginalAveraging final : public SingleSpringLaw {
 public:
  using SingleSpringLaw::SingleSpringLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    return force_along_mean(contacts, K_, [&contacts](double length) {
      simd::Pack depths(0.0);
      for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) depths += simd::load(&contacts.depth[i]);
      return simd::sum(depths) / length;
    });
  }
};

class HighestDepth final : public SingleSpringLaw {
 public:
  using SingleSpringLaw::SingleSpringLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    return force_along_mean(contacts, K_, [&contacts](double) {
      const auto depths = contacts.depth.begin();
      return *std::max_element(depths, depths + static_cast<std::ptrdiff_t>(contacts.size()));
    });
  }
};

/// sum d_i / |sum u_i|, where |sum u_i| > kCancelledBelow n, or the force is zero.
double original_averaging_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e9 * std::min(1.0, static_cast<double>(n)) * depth;
}

/// d_r is one of the depths and u_r a unit vector.
double highest_depth_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min(1.0, static_cast<double>(n)) * depth;
}

/// S = u_r u_r^T, and the mean gradient u_r points straight into the wedge.
WedgeStiffness averaged_direction_wedge(const RenderingConfig&, double, double) {
  return {1.0, 0.0};
}

}  // namespace

AlgorithmEntry original_averaging_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "original_averaging",
      .summary = "the trainer's original algorithm (DP): depths summed, gradients averaged",
      .formula =
          "u_r = sum u_i / |sum u_i|, d_r = sum d_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T; "
          "zero force when |sum u_i| <= 1e-9 n",
      .source = "thesis B.2, Eq. B.1; always with depth model shortest_distance and without reduction",
      .known_failure = "opposite gradients make d_r explode and u_r flip by 180 degrees (thesis B.3.3): vibration",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<OriginalAveraging>,
          .theory = {.force_bound = original_averaging_bound, .wedge_stiffness = averaged_direction_wedge},
          .fixed_depth_model = "shortest_distance",
          .may_reduce = false,
          .creates_energy = true};
}

AlgorithmEntry highest_depth_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "highest_depth",
      .summary = "one spring, as deep as the deepest contact, along the averaged gradient",
      .formula =
          "u_r = sum u_i / |sum u_i|, d_r = max d_i, f = -K d_r u_r, S = u_r u_r^T; zero force when "
          "|sum u_i| <= 1e-9 n; always without reduction",
      .source = "thesis 4.1, which says of it (its reference 3) that it vibrates in a hole",
      .known_failure =
          "u_r turns round by 180 degrees as one of nearly opposite contacts comes or goes, and d_r jumps from contact "
          "to contact: the force jumps by up to 2 K d_r",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<HighestDepth>,
          .theory = {.force_bound = highest_depth_bound, .wedge_stiffness = averaged_direction_wedge},
          .may_reduce = false};
}

}  // namespace hapbench
