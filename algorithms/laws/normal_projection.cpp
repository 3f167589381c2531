#include "algorithms/laws/normal_projection.hpp"

#include "algorithms/laws/shaped_stiffness.hpp"

namespace hapbench {

const ModelInfo kNormalProjectionInfo = {
    .name = "normal_projection",
    .summary = "stiffness shaping on the depth model normal_projection",
    .formula = "weights of shaped_stiffness; d_i = exit distance along -n_i (see depth model normal_projection)",
    .source = "thesis F.1; always with depth model normal_projection",
    .known_failure = "the force jumps when a point appears at a corner (Fig. F.4)",
    .parameters = kShapedStiffnessInfo.parameters,
};

std::unique_ptr<ForceLaw> make_normal_projection(const RenderingConfig& config) {
  return make_shaped_stiffness(config);
}

}  // namespace hapbench
