#include "algorithms/depth/shortest_distance.hpp"

namespace hapbench {

const ModelInfo kShortestDistanceInfo = {
    .name = "shortest_distance",
    .summary = "distance to the nearest surface of the tool, gradient towards it",
    .formula = "d = |q - x|, u = (q - x) / d, with q the place of the tool's surface nearest to the point x",
    .source =
        "thesis B.1, with depths >= 0 of which the smallest wins (as printed, negative depths would pull the tool in)",
    .known_failure = "the gradient flips by 180 degrees when a point crosses the tool's median line (thesis B.3.1)",
};

namespace {

class ShortestDistance final : public DepthModel {
 public:
  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    tool.shortest_depths(pose, contacts);
    tool.shortest_gradients(pose, contacts);
    contacts.pad();
  }
};

}  // namespace

std::unique_ptr<DepthModel> make_shortest_distance() {
  return std::make_unique<ShortestDistance>();
}

}  // namespace hapbench
