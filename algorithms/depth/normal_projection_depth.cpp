#include "algorithms/depth/normal_projection_depth.hpp"

namespace hapbench {

const ModelInfo kNormalProjectionDepthInfo = {
    .name = "normal_projection",
    .summary = "distance along the inverse surface normal to where it leaves the tool",
    .formula = "u = -n, d = smallest d > 0 at which the ray x + d u leaves the tool (a cylinder: F.7, F.9, F.12)",
    .source = "thesis F.1 (F.6 printed with a minus; F.7 shows that r_p + d r_n is meant)",
    .known_failure = "a point that appears at a corner can start with a large depth: the force jumps (Fig. F.4)",
};

namespace {

class NormalProjectionDepth final : public DepthModel {
 public:
  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      contacts.set_gradient(i, -contacts.normal(i));
    }
    tool.exit_distances(pose, contacts, contacts.depth.data());
    contacts.pad();
  }
};

}  // namespace

std::unique_ptr<DepthModel> make_normal_projection_depth() {
  return std::make_unique<NormalProjectionDepth>();
}

}  // namespace hapbench
