#include <cmath>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

/// Laws that use the sum of the gradients. original_averaging and highest_depth have one spring along the
/// averaged gradient: u_r = sum u_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T. They differ in the depth d_r.
namespace hapbench {
namespace {

/// Smallest norm of the mean gradient, |sum u_i| / n, that gives a force. Below this norm, the direction is rounding
/// noise, and the force is zero.
constexpr double kMinMeanGradient = 1e-9;

/// A law with one spring, compressed by d_r = depth(contacts, |sum u_i|) [m]. The laws original_averaging and
/// highest_depth do not define the point at which the force acts. All weights are therefore set to 1, so that the force
/// acts at the mean position of the contacts.
template <double (*depth)(const ContactBuffer&, double) noexcept>
class AveragedDirection final : public SingleSpringLaw {
 public:
  using SingleSpringLaw::SingleSpringLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Vec3 gradients = gradient_sum(contacts);
    const double length = gradients.norm();
    if (length <= kMinMeanGradient * static_cast<double>(contacts.size())) return {};
    const Vec3 u = gradients / length;
    return {-K_ * depth(contacts, length) * u, u * u.transpose()};
  }
};

double averaged_depth(const ContactBuffer& contacts, double length) noexcept {
  simd::Pack depths(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) depths += simd::load(&contacts.depth[i]);
  return simd::sum(depths) / length;
}

double highest_depth(const ContactBuffer& contacts, double) noexcept {
  const auto depths = contacts.depth.begin();
  return *std::max_element(depths, depths + static_cast<std::ptrdiff_t>(contacts.size()));
}

/// Bound of |f_spring| / K for n contacts with depths <= d. The force is zero unless |sum u_i| > kMinMeanGradient n.
/// Then |f_spring| / K = sum d_i / |sum u_i| < d / kMinMeanGradient.
double original_averaging_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e9 * std::min(1.0, static_cast<double>(n)) * depth;
}

/// Limit of sigma = sum beta_i d_i^2 / sum d_i^2, with the ratios beta_i of cancelling_ratio(). If sigma is at most
/// this limit, the springs cancel each other, and a division by sigma would amplify rounding noise. The force is then
/// zero.
constexpr double kMinEnergyRatio = 1e-12;

class Tandpasta final : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    const Vec3 total = gradient_sum(contacts);
    double scaled = 0.0;
    double energy = 0.0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const double beta = cancelling_ratio(contacts, contacts.gradient(i), total);
      const double d2 = contacts.depth[i] * contacts.depth[i];
      contacts.weight[i] = beta;
      scaled += beta * d2;
      energy += d2;
    }
    const double sigma = energy > 0.0 ? scaled / energy : 0.0;
    if (!(sigma > kMinEnergyRatio)) {
      set_weights(contacts, 0.0);
      return {};
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.weight[i] /= sigma;
    return weighted_force(contacts, K_);
  }

 private:
  /// Returns the ratio beta = |sum_j <u, u_j>| / sum_j |<u, u_j>| of the gradient u: 1 if no gradient u_j opposes u, 0
  /// if the inner products cancel. The numerator equals |<u, total>| with the sum `total` of all gradients, so only the
  /// denominator needs a loop over the contacts. O(n).
  static double cancelling_ratio(const ContactBuffer& c, const Vec3& u, const Vec3& total) noexcept {
    using simd::load, simd::Pack;
    const Pack x(u.x()), y(u.y()), z(u.z());
    Pack magnitudes(0.0);
    for (std::size_t j = 0; j < c.padded_size(); j += simd::lanes) {
      magnitudes += simd::abs(x * load(&c.ux[j]) + y * load(&c.uy[j]) + z * load(&c.uz[j]));
    }
    const double denominator = simd::sum(magnitudes);
    return denominator > 0.0 ? std::abs(u.dot(total)) / denominator : 0.0;
  }
};

/// Bound of |f_spring| / K. c = beta / sigma preserves the energy: sum c d_i^2 = sum d_i^2 <= n d^2. Also sum c
/// <= n / sigma, since beta <= 1. By Cauchy and Schwarz, sum c d_i <= n d / sqrt(sigma). The force is zero unless
/// sigma > kMinEnergyRatio.
double tandpasta_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e6 * static_cast<double>(n) * depth;
}

}  // namespace

AlgorithmEntry original_averaging_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "original_averaging",
      .summary = "original algorithm of the trainer (DP): sum of the depths along the mean gradient",
      .formula =
          "u_r = sum u_i / |sum u_i|, d_r = sum d_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T; "
          "zero force when |sum u_i| <= 1e-9 n",
      .source = "thesis B.2, Eq. B.1; always with depth model shortest_distance and without reduction",
      .known_failure =
          "nearly opposite gradients make d_r very large and flip u_r by 180 degrees (thesis B.3.3): vibration",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<AveragedDirection<averaged_depth>>,
          .force_bound = original_averaging_bound,
          .fixed_depth_model = "shortest_distance",
          .may_reduce = false};
}

AlgorithmEntry highest_depth_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "highest_depth",
      .summary = "one spring with the depth of the deepest contact, along the mean gradient",
      .formula =
          "u_r = sum u_i / |sum u_i|, d_r = max d_i, f = -K d_r u_r, S = u_r u_r^T; zero force when "
          "|sum u_i| <= 1e-9 n; always without reduction",
      .source = "thesis 4.1, which states (citing its reference 3) that it vibrates in a hole",
      .known_failure =
          "u_r flips by 180 degrees when one of nearly opposite contacts appears or disappears, and d_r jumps from "
          "contact to contact: the force jumps by up to 2 K d_r",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<AveragedDirection<highest_depth>>,
          // d_r is one of the depths and u_r a unit vector, so the force is at most the force of one spring.
          .force_bound = bound_of_springs<1>,
          .may_reduce = false};
}

AlgorithmEntry tandpasta_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "tandpasta",
      .summary = "moves elastic energy from springs that oppose each other to springs that do not",
      .formula =
          "beta_i = |sum_j <u_i,u_j>| / sum_j |<u_i,u_j>|, sigma_E = sum beta_i d_i^2 / sum d_i^2, "
          "c_i = beta_i / sigma_E; zero force when sigma_E <= 1e-12",
      .source = "thesis F.2",
      .known_failure = "increases the outward force until the tool jumps out; cost O(n^2)",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo, .make_law = law_of<Tandpasta>, .force_bound = tandpasta_bound};
}

}  // namespace hapbench
