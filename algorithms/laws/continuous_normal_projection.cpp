#include "algorithms/laws/continuous_normal_projection.hpp"

#include "algorithms/laws/shaped_stiffness.hpp"

namespace hapbench {

const ModelInfo kContinuousNormalProjectionInfo = {
    .name = "continuous_normal_projection",
    .summary = "stiffness shaping on the depth model continuous_normal_projection: no jump at corners",
    .formula =
        "weights of shaped_stiffness; d_i starts as the shortest distance and follows the tool along -n_i up to its "
        "exit "
        "(see depth model continuous_normal_projection)",
    .source = "ours, after thesis F.1; always with depth model continuous_normal_projection",
    .known_failure =
        "depends on the way: under a face that it slid in below sideways, the tool feels the shortest distance only",
    .parameters = kShapedStiffnessInfo.parameters,
};

std::unique_ptr<ForceLaw> make_continuous_normal_projection(const RenderingConfig& config) {
  return make_shaped_stiffness(config);
}

}  // namespace hapbench
