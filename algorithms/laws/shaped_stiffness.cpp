#include "algorithms/laws/shaped_stiffness.hpp"

#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kParameters[] = {
    kStiffnessParameter,
    {parameter::kIterations, "m: updates of the weights; 0 is summation"},
};

}  // namespace

const ModelInfo kShapedStiffnessInfo = {
    .name = "shaped_stiffness",
    .summary = "the thesis's stiffness shaping (HS): the combined stiffness along every contact is drawn to K",
    .formula = "c = 1; m times: rho_i = sum_j c_j <u_i, u_j>^2 = u_i^T S u_i, c_i <- c_i / rho_i",
    .source = "thesis 2.4, C.4.2; rho through the 3x3 tensor, Eq. 3 and 4",
    .known_failure =
        "rho_i stays above 1 where the weight dies out (it is a projection onto a cone); soft along the way out of a "
        "wedge, because only ratios along contacts are regulated: 2 sin^2 w / (1 + cos^2 2w) K, about w^2 K, for half "
        "angle w (10 degrees: 0.032 K), and in a cone 2 sin^2 w / (cos^4 w + 2 sin^4 w) K, about 2 w^2 K",
    .parameters = kParameters,
};

Mat3 update_shaped_weights(ContactBuffer& contacts, const Mat3& S) noexcept {
  using simd::load, simd::Pack;
  const Pack xx(S(0, 0)), yy(S(1, 1)), zz(S(2, 2)), two_xy(2.0 * S(0, 1)), two_xz(2.0 * S(0, 2)), two_yz(2.0 * S(1, 2));
  const Pack zero(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    const Pack rho = x * (xx * x + two_xy * y + two_xz * z) + y * (yy * y + two_yz * z) + zz * z * z;
    // Zero gradients (and the padding) have ratio zero and stay without weight.
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
  ShapedStiffness(double stiffness, int iterations) : ForceLaw(stiffness), m_(iterations) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    iterations_ += static_cast<std::uint64_t>(m_);
    const Mat3 S = shape_weights(contacts, m_);
    return {-K_ * weighted_depth(contacts), S};
  }

 private:
  int m_;
};

}  // namespace

std::unique_ptr<ForceLaw> make_shaped_stiffness(const RenderingConfig& config) {
  return std::make_unique<ShapedStiffness>(config.stiffness, config.iterations);
}

}  // namespace hapbench
