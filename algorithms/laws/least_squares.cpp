#include <Eigen/Cholesky>
#include <cmath>

#include "algorithms/parameters.hpp"
#include "algorithms/registry.hpp"

namespace hapbench {
namespace {

/// The energy of the law is that of its mechanical equivalent: penalty springs of stiffness K / eps in series with one
/// coupling spring of stiffness K, which is stretched by f / K = -x.
class LeastSquares final : public ForceLaw {
 public:
  explicit LeastSquares(const RenderingConfig& config) : ForceLaw(config), eps_(config.regularisation) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    normal_equations_.compute(eps_ * Mat3::Identity() + S_sum);
    const Mat3 S = normal_equations_.solve(S_sum);
    // S_sum and the inverse commute, so S is symmetric; averaging removes the rounding of the solve.
    return {-K_ * normal_equations_.solve(weighted_depth(contacts)), 0.5 * (S + S.transpose())};
  }

  /// E = K / (2 eps) min over x of sum (d_i - <u_i, x>)^2 + eps |x|^2. Its gradient with respect to the position of the
  /// tool is K x = -f. The first term is the energy of the penalty springs at the depths that x leaves, the second that
  /// of the coupling.
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    if (K_ == 0.0) return {};
    const Vec3 minus_x = spring / K_;
    SpringState state = shifted_springs(contacts, minus_x, tip, K_ / eps_);
    state.energy += 0.5 * spring.dot(minus_x);
    return state;
  }

  /// Velocities are resolved like depths.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return normal_equations_.solve(ForceLaw::turning_velocity(contacts, S, tool));
  }

 private:
  double eps_;
  Eigen::LLT<Mat3> normal_equations_;  ///< of eps I + S_sum of the last contacts; positive definite
};

/// x = (eps I + U U^T)^-1 U d with the gradients in the columns of U. By the singular values s of U,
/// |x| <= max s / (eps + s^2) |d|, at most 1 / (2 sqrt eps) where s^2 = eps, and |d| <= sqrt(n) times the deepest.
double least_squares_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n) / config.regularisation) * depth;
}

/// The stiffness along an axis of S_sum with eigenvalue s is s / (eps + s).
WedgeStiffness least_squares_wedge(const RenderingConfig& config, double w, double n) {
  const auto resolved = [eps = config.regularisation](double s) { return s / (eps + s); };
  const auto [along, across] = wedge_of_weight(n, w);
  return {resolved(along), resolved(across)};
}

}  // namespace

AlgorithmEntry least_squares_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kRegularisation, "eps: weight of a short translation against resolving the depths"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "least_squares",
      .summary = "one spring along the one translation that best resolves all depths",
      .formula =
          "x = argmin sum (d_i - <u_i, x>)^2 + eps |x|^2 = (eps I + S_sum)^-1 sum d_i u_i, f = -K x, "
          "S = (eps I + S_sum)^-1 S_sum, S_sum = sum u u^T; always without reduction",
      .source = "ours (Tikhonov's regularised least squares); virtual_coupling with stiffness K / eps is the same law",
      .known_failure =
          "a small eps makes S jump as the first contact along a direction comes or the last one goes, and contacts that "
          "nearly oppose push the tool out by up to 1 / (2 sqrt eps) times the norm of their depths",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<LeastSquares>,
          .theory = {.force_bound = least_squares_bound, .wedge_stiffness = least_squares_wedge},
          .may_reduce = false};
}

}  // namespace hapbench
