#include <Eigen/Cholesky>
#include <cmath>

#include "algorithms/parameters.hpp"
#include "algorithms/registry.hpp"

namespace hapbench {
namespace {

class VirtualCoupling final : public ForceLaw {
 public:
  explicit VirtualCoupling(const RenderingConfig& config)
      : ForceLaw(config), K_over_K_vc_(config.virtual_coupling ? config.stiffness / *config.virtual_coupling : 1.0) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    // The formula divided by K_vc, so that K = 0 needs no case of its own. Positive definite: S_sum is a sum of u u^T.
    series_.compute(Mat3::Identity() + K_over_K_vc_ * S_sum);
    const Mat3 S = series_.solve(S_sum);
    // S_sum and the inverse commute, so S is symmetric; averaging removes the rounding of the solve.
    return {-K_ * series_.solve(weighted_depth(contacts)), 0.5 * (S + S.transpose())};
  }

  /// The coupling spring is stretched by f / K_vc, which relieves every penalty spring: depth d_i + <u_i, f> / K_vc.
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    if (K_ == 0.0) return {};
    const Vec3 stretch = spring * (K_over_K_vc_ / K_);
    SpringState state = shifted_springs(contacts, stretch, tip, K_);
    state.energy += 0.5 * spring.dot(stretch);
    return state;
  }

  /// The coupling passes velocities on as it does depths.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return series_.solve(ForceLaw::turning_velocity(contacts, S, tool));
  }

 private:
  double K_over_K_vc_;
  Eigen::LLT<Mat3> series_;  ///< of I + K / K_vc S_sum of the last contacts
};

/// (I + U U^T)^-1 U has the singular values s / (1 + s^2) <= 1/2, and |(d_1 … d_n)| <= sqrt(n) d.
/// Precondition: K_vc = K.
double virtual_coupling_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n)) * depth;
}

/// The summed stiffness in series with K_vc, along each axis separately.
WedgeStiffness virtual_coupling_wedge(const RenderingConfig& config, double w, double n) {
  const double k = config.virtual_coupling.value_or(config.stiffness) / config.stiffness;
  const auto in_series = [k](double x) { return k * x / (k + x); };
  const auto [along, across] = wedge_of_weight(n, w);
  return {in_series(along), in_series(across)};
}

}  // namespace

AlgorithmEntry virtual_coupling_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kVirtualCoupling, "K_vc: stiffness of the coupling spring; null: K"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "virtual_coupling",
      .summary = "all springs in series with one quasi-static coupling spring",
      .formula =
          "f = -K_vc (K_vc I + K S_sum)^-1 K sum d_i u_i, S = K_vc (K_vc I + K S_sum)^-1 S_sum, S_sum = sum u u^T",
      .source = "thesis Fig. 2d",
      .known_failure = "bounds the stiffness, but the force still follows the direction with most points",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<VirtualCoupling>,
          .theory = {.force_bound = virtual_coupling_bound, .wedge_stiffness = virtual_coupling_wedge}};
}

}  // namespace hapbench
