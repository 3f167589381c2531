#include <algorithm>

#include "algorithms/laws/laws.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kMeanParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kMeanInfo = {
    .name = "mean",
    .summary = "penalty springs averaged over the number of points",
    .formula = "c_i = 1/n",
    .source = "thesis Fig. 2c",
    .known_failure =
        "directions with few points get almost no stiffness: the tool sinks in where most points are parallel",
    .parameters = kMeanParameters,
};

namespace {

class Mean final : public ForceLaw {
 public:
  explicit Mean(double stiffness) : ForceLaw(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0 / static_cast<double>(contacts.size()));
    return weighted_force(contacts, K_);
  }
};

/// |sum c d u| <= d sum c, and c = 1 / n.
double mean_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min(1.0, static_cast<double>(n)) * depth;
}

WedgeStiffness mean_wedge(const RenderingConfig&, double w, double) {
  return wedge_of_weight(0.5, w);
}

}  // namespace

const AlgorithmTheory kMeanTheory = {.force_bound = mean_bound, .wedge_stiffness = mean_wedge};

std::unique_ptr<ForceLaw> make_mean(const RenderingConfig& config) {
  return std::make_unique<Mean>(config.stiffness);
}

}  // namespace hapbench
