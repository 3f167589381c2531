#include <algorithm>

#include "algorithms/laws/laws.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kMcNeelyParameters[] = {kStiffnessParameter};
constexpr OwnParameter kPoints[] = {
    {"points", {1.0, 1e5, "1"}, 10.0, "most springs that add up before they are scaled"}};

}  // namespace

const ModelInfo kMcNeelyInfo = {
    .name = "mcneely",
    .summary = "the 10/N rule: springs added, and of more than ten their sum scaled to that of ten",
    .formula = "c_i = min(1, p / n), p = 10 points, n colliding points; always without reduction",
    .source =
        "McNeely, Puterbaugh and Troy, Six degree-of-freedom haptic rendering using voxel sampling (SIGGRAPH 1999)",
    .known_failure =
        "the sum is still ten times as stiff as one spring where all points share a direction, and the force follows "
        "the direction with most points; a point that comes or goes rescales all others",
    .parameters = kMcNeelyParameters,
};

const std::span<const OwnParameter> kMcNeelyOwnParameters = kPoints;

namespace {

double points_of(const RenderingConfig& config) {
  return own_value(config, kMcNeelyInfo.name, kPoints[0]);
}

class McNeely final : public ForceLaw {
 public:
  McNeely(double stiffness, double points) : ForceLaw(stiffness), points_(points) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    const auto n = static_cast<double>(contacts.size());
    set_weights(contacts, n > points_ ? points_ / n : 1.0);
    return weighted_force(contacts, K_);
  }

 private:
  double points_;
};

/// n springs with the weight min(1, p / n), all in one direction.
double mcneely_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  return std::min(static_cast<double>(n), points_of(config)) * depth;
}

WedgeStiffness mcneely_wedge(const RenderingConfig& config, double w, double n) {
  return wedge_of_weight(std::min(n, 0.5 * points_of(config)), w);
}

}  // namespace

const AlgorithmTheory kMcNeelyTheory = {.force_bound = mcneely_bound, .wedge_stiffness = mcneely_wedge};

std::unique_ptr<ForceLaw> make_mcneely(const RenderingConfig& config) {
  return std::make_unique<McNeely>(config.stiffness, points_of(config));
}

}  // namespace hapbench
