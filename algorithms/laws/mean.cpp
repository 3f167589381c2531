#include "algorithms/laws/mean.hpp"

namespace hapbench {

namespace {

constexpr ParameterInfo kParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kMeanInfo = {
    .name = "mean",
    .summary = "penalty springs averaged over the number of points",
    .formula = "c_i = 1/n",
    .source = "thesis Fig. 2c",
    .known_failure =
        "directions with few points get almost no stiffness: the tool sinks in where most points are parallel",
    .parameters = kParameters,
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

}  // namespace

std::unique_ptr<ForceLaw> make_mean(const RenderingConfig& config) {
  return std::make_unique<Mean>(config.stiffness);
}

}  // namespace hapbench
