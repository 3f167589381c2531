#include "algorithms/laws/exact_shaping.hpp"

#include <algorithm>

#include "algorithms/laws/cone_projection.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kExactShapingParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kExactShapingInfo = {
    .name = "exact_shaping",
    .summary = "what the shaping iteration converges to, computed exactly",
    .formula =
        "c = argmin ½|S - I|²_F + (epsilon/2)|c|² over c >= 0, epsilon = 1e-6: the projection of the identity onto "
        "the cone of contact tensors u u^T",
    .source = "ours; the iteration is the multiplicative update of Sha, Lin, Saul, Lee, Neural Computation 2007",
    .known_failure =
        "as shaped_stiffness: ratios above 1 where the weight is zero; soft along the way out of a wedge, "
        "2 sin^2 w / (1 + cos^2 2w) K for half angle w, about w^2 K",
    .parameters = kExactShapingParameters,
};

namespace {

using simd::load, simd::Pack;

/// u u^T of the contacts.
struct GradientTensors {
  const ContactBuffer& contacts;
  std::size_t size, padded_size;
  double* weight;

  explicit GradientTensors(ContactBuffer& c)
      : contacts(c), size(c.size()), padded_size(c.padded_size()), weight(c.weight.data()) {}

  cone_projection::TensorPack pack(std::size_t i) const {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    const Pack root2(std::numbers::sqrt2);
    return {{x * x, y * y, z * z, root2 * x * y, root2 * x * z, root2 * y * z}};
  }
};

}  // namespace

static_assert(kExactShapingEpsilon == cone_projection::kEps);

int solve_exact_shaping(ContactBuffer& contacts) noexcept {
  set_weights(contacts, 1.0);
  return cone_projection::solve(GradientTensors(contacts));
}

namespace {

class ExactShaping final : public ForceLaw {
 public:
  explicit ExactShaping(double stiffness) : ForceLaw(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    iterations_ += static_cast<std::uint64_t>(solve_exact_shaping(contacts));
    return weighted_force(contacts, K_);
  }
};

/// sum c: at the optimum tr S >= |S|^2_F >= (tr S)^2 / 3, so that tr S <= 3, and tr S = sum c.
double exact_shaping_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min(3.0, static_cast<double>(n)) * depth;
}

/// The limit of the iteration; epsilon = 1e-6 of it apart. Under merged_shaping each face is a group.
WedgeStiffness exact_shaping_wedge(const RenderingConfig&, double w, double) {
  return wedge_of_weight(shaped_wedge_weight(w), w);
}

}  // namespace

const AlgorithmTheory kExactShapingTheory = {.force_bound = exact_shaping_bound,
                                             .wedge_stiffness = exact_shaping_wedge};

std::unique_ptr<ForceLaw> make_exact_shaping(const RenderingConfig& config) {
  return std::make_unique<ExactShaping>(config.stiffness);
}

}  // namespace hapbench
