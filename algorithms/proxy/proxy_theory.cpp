#include "algorithms/proxy/proxy_rendering.hpp"

namespace hapbench {
namespace {

/// Placed on the tool, the proxy moves by at most a margin a pass, however deep the contacts are.
double proxy_bound(const RenderingConfig&, const ToolShape& tool, std::size_t, double) {
  return kProxyPasses * kProxyMargin * tool.half_width();
}

/// The projector onto the plane that the two gradients span.
WedgeStiffness proxy_wedge(const RenderingConfig&, double, double) {
  return {1.0, 1.0};
}

}  // namespace

const AlgorithmTheory kProxyTheory = {.force_bound = proxy_bound, .wedge_stiffness = proxy_wedge};

}  // namespace hapbench
