#include "algorithms/laws/laws.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kSummationParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kSummationInfo = {
    .name = "summation",
    .summary = "all penalty springs added",
    .formula = "c_i = 1",
    .source = "thesis 1.2, Fig. 2b",
    .known_failure =
        "stiffness and damping grow with the number of points: unstable once lambda_max(S) K passes the "
        "integrator's limit (thesis A.3)",
    .parameters = kSummationParameters,
};

namespace {

class Summation final : public ForceLaw {
 public:
  explicit Summation(double stiffness) : ForceLaw(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    return weighted_force(contacts, K_);
  }
};

/// All springs pull in one direction.
double summation_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return static_cast<double>(n) * depth;
}

WedgeStiffness summation_wedge(const RenderingConfig&, double w, double n) {
  return wedge_of_weight(n, w);
}

}  // namespace

const AlgorithmTheory kSummationTheory = {.force_bound = summation_bound, .wedge_stiffness = summation_wedge};

std::unique_ptr<ForceLaw> make_summation(const RenderingConfig& config) {
  return std::make_unique<Summation>(config.stiffness);
}

}  // namespace hapbench
