#include "algorithms/depth/surface_normal.hpp"

#include "sim/core/simd.hpp"

namespace hapbench {

const ModelInfo kSurfaceNormalInfo = {
    .name = "surface_normal",
    .summary = "depth of shortest_distance, gradient against the surface normal (default)",
    .formula = "d as in shortest_distance, u = -n",
    .source = "thesis C.1, 2.3",
    .known_failure = "underestimates the depth; on a flat it saturates at half the tool's width (thesis C.1, F.1)",
};

namespace {

class SurfaceNormal final : public DepthModel {
 public:
  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    tool.shortest_depths(pose, contacts);
    for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
      simd::store(-simd::load(&contacts.nx[i]), &contacts.ux[i]);
      simd::store(-simd::load(&contacts.ny[i]), &contacts.uy[i]);
      simd::store(-simd::load(&contacts.nz[i]), &contacts.uz[i]);
    }
    contacts.pad();
  }
};

}  // namespace

std::unique_ptr<DepthModel> make_surface_normal() {
  return std::make_unique<SurfaceNormal>();
}

}  // namespace hapbench
