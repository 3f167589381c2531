#include "algorithms/laws/shaped_stiffness.hpp"

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {

Mat3 update_shaped_weights(ContactBuffer& contacts, const Mat3& S) noexcept {
  using simd::load, simd::Pack;
  const Pack xx(S(0, 0)), yy(S(1, 1)), zz(S(2, 2)), two_xy(2.0 * S(0, 1)), two_xz(2.0 * S(0, 2)), two_yz(2.0 * S(1, 2));
  const Pack zero(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    const Pack rho = x * (xx * x + two_xy * y + two_xz * z) + y * (yy * y + two_yz * z) + zz * z * z;
    // Zero gradients and the padding have ratio zero and get weight zero.
    const Pack c = simd::select(rho > zero, load(&contacts.weight[i]) / rho, zero);
    simd::store(c, &contacts.weight[i]);
  }
  return stiffness_tensor(contacts);
}

Mat3 shape_weights(ContactBuffer& contacts, int iterations) noexcept {
  set_weights(contacts, 1.0);
  Mat3 S = stiffness_tensor(contacts);
  for (int m = 0; m < iterations; ++m) S = update_shaped_weights(contacts, S);
  return S;
}

namespace {

class ShapedStiffness final : public ForceLaw {
 public:
  explicit ShapedStiffness(const RenderingConfig& config) : ForceLaw(config), m_(config.iterations) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    iterations_ += static_cast<std::uint64_t>(m_);
    const Mat3 S = shape_weights(contacts, m_);
    return {-K_ * weighted_depth(contacts), S};
  }

 private:
  int m_;
};

/// Bound of |f_spring| / K. For unit u_i, rho_i = u_i^T S u_i >= 1 / (u_i^T S^+ u_i) by Cauchy and Schwarz,
/// with the pseudoinverse S^+. After an update c_i <- c_i / rho_i, sum c_i / rho_i <= sum c_i u_i^T S^+ u_i =
/// tr(S^+ S) <= 3. Without an update the law is summation.
double shaped_stiffness_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  const double all_springs = static_cast<double>(n);
  return (config.iterations > 0 ? std::min(3.0, all_springs) : all_springs) * depth;
}

constexpr ParameterInfo kShapingParameters[] = {
    kStiffnessParameter,
    {parameter::kIterations, "m: number of updates of the weights; 0 is the same as summation"},
};

/// Returns the entry of an algorithm with this law. `depth_model`: depth model that the algorithm prescribes;
/// empty for none.
AlgorithmEntry shaping_entry(const ModelInfo& info, std::string_view depth_model = {}) {
  return {.info = &info,
          .make_law = law_of<ShapedStiffness>,
          .force_bound = shaped_stiffness_bound,
          .fixed_depth_model = depth_model};
}

}  // namespace

AlgorithmEntry shaped_stiffness_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "shaped_stiffness",
      .summary =
          "stiffness shaping of the thesis (HS): weights that bring the combined stiffness along every contact to K",
      .formula = "c = 1; m times: rho_i = sum_j c_j <u_i, u_j>^2 = u_i^T S u_i, c_i <- c_i / rho_i",
      .source = "thesis 2.4, C.4.2; rho through the 3x3 tensor, Eq. 3 and 4",
      .known_failure =
          "the force jumps when contacts appear or disappear, so that its bounds hold only between such events; rho_i "
          "stays above 1 where the weight tends to zero (the limit of the iteration is a projection onto a cone); soft "
          "in the direction out of a wedge, because only ratios along contacts are regulated: 2 sin^2 w / (1 + cos^2 "
          "2w) K, about w^2 K, for half angle w (10 degrees: 0.032 K), and in a cone 2 sin^2 w / (cos^4 w + 2 sin^4 w) "
          "K, about 2 w^2 K",
      .parameters = kShapingParameters,
  };
  return shaping_entry(kInfo);
}

AlgorithmEntry normal_projection_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "normal_projection",
      .summary = "stiffness shaping with the depth model normal_projection",
      .formula = "weights of shaped_stiffness; d_i = exit distance along -n_i (see depth model normal_projection)",
      .source = "thesis F.1; always with depth model normal_projection",
      .known_failure = "the force jumps when a point appears at a corner (Fig. F.4)",
      .parameters = kShapingParameters,
  };
  return shaping_entry(kInfo, "normal_projection");
}

AlgorithmEntry continuous_normal_projection_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "continuous_normal_projection",
      .summary = "stiffness shaping with the depth model continuous_normal_projection: no jump at corners",
      .formula =
          "weights of shaped_stiffness; d_i starts as the shortest distance and follows the tool along -n_i up to "
          "its exit (see depth model continuous_normal_projection)",
      .source = "not in the thesis, based on thesis F.1; always with depth model continuous_normal_projection",
      .known_failure =
          "depends on the path: under a face that the tool entered from the side, the depth is only the shortest "
          "distance",
      .parameters = kShapingParameters,
  };
  return shaping_entry(kInfo, "continuous_normal_projection");
}

}  // namespace hapbench
