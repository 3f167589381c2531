#include <cmath>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {

namespace {

/// Below this scaled energy, every spring is cancelled by another and the normalisation would divide by rounding noise.
constexpr double kNoEnergyBelow = 1e-12;

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
    if (!(sigma > kNoEnergyBelow)) {
      set_weights(contacts, 0.0);
      return {};
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.weight[i] /= sigma;
    return weighted_force(contacts, K_);
  }

 private:
  /// beta of the gradient u: 1 if no other gradient opposes it, 0 if all cancel. The sum of inner products is the inner
  /// product with the sum of gradients; only the sum of magnitudes needs the O(n) loop.
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

/// c = beta / sigma keeps the energy: sum c d_i^2 = sum d_i^2 <= n d^2, and sum c <= n / sigma, since beta <= 1.
/// Cauchy and Schwarz: sum c d_i <= n d / sqrt(sigma), where sigma > kNoEnergyBelow, or the force is zero.
double tandpasta_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e6 * static_cast<double>(n) * depth;
}

/// In a wedge every spring has the same beta, which sigma_E cancels.
WedgeStiffness tandpasta_wedge(const RenderingConfig&, double w, double n) {
  return wedge_of_weight(n, w);
}

}  // namespace

AlgorithmEntry tandpasta_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "tandpasta",
      .summary = "elastic energy moved from springs that fight each other to those that do not",
      .formula =
          "beta_i = |sum_j <u_i,u_j>| / sum_j |<u_i,u_j>|, sigma_E = sum beta_i d_i^2 / sum d_i^2, "
          "c_i = beta_i / sigma_E; zero force when sigma_E <= 1e-12",
      .source = "thesis F.2",
      .known_failure = "boosts the outward force until the tool jumps out; O(n^2)",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<Tandpasta>,
          .theory = {.force_bound = tandpasta_bound, .wedge_stiffness = tandpasta_wedge},
          .creates_energy = true};
}

}  // namespace hapbench
