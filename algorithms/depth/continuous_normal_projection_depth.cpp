#include "algorithms/depth/continuous_normal_projection_depth.hpp"

#include <algorithm>
#include <vector>

#include "sim/tool/tool_state.hpp"

namespace hapbench {

const ModelInfo kContinuousNormalProjectionDepthInfo = {
    .name = "continuous_normal_projection",
    .summary = "starts as the shortest distance, then follows the tool's motion along the gradient up to its exit",
    .formula =
        "u = -n, d = d_sd when the point enters, then d <- min(d_np, max(d_sd, d + <dx, u>)); d_sd of "
        "shortest_distance, d_np of normal_projection, dx = dp + turn x (x - p) of the tool at the point",
    .source = "thesis F.1 names the jump (Fig. F.4) and two remedies with their flaws; this one is ours",
    .known_failure =
        "depends on the way: what was entered sideways is only as deep as the shortest distance; a point that leaves "
        "sideways still drops its whole depth at once",
};

namespace {

class ContinuousNormalProjectionDepth final : public DepthModel {
 public:
  void prepare(const PointShell& shell) override {
    memory_.resize(shell.size());
    exit_.resize(shell.size());
  }

  void reset() noexcept override {
    std::fill(memory_.begin(), memory_.end(), Memory{});
    step_ = kNever + 1;
  }

  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    ++step_;
    tool.shortest_depths(pose, contacts);
    const Vec3 moved = pose.position - last_.position, turned = turn(last_, pose);
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.set_gradient(i, -contacts.normal(i));
    tool.exit_distances(pose, contacts, exit_.data());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3 x = contacts.point(i), u = contacts.gradient(i);
      Memory& point = memory_[contacts.index[i]];
      const bool stays = point.step + 1 == step_;
      const double pressed = stays ? point.depth + (moved + turned.cross(x - pose.position)).dot(u) : 0.0;
      const double least = std::max(contacts.depth[i], 0.0);  // rounding may put a point on the surface outside
      point = {std::min(std::max(least, pressed), exit_[i]), step_};
      contacts.depth[i] = point.depth;
    }
    contacts.pad();
    last_ = pose;
  }

 private:
  static constexpr std::uint64_t kNever = 0;

  struct Memory {
    double depth = 0.0;           ///< d [m]
    std::uint64_t step = kNever;  ///< in which the point was in the tool last
  };

  std::vector<Memory> memory_;  ///< of every point of the shell
  std::vector<double> exit_;    ///< d_np of every contact [m]
  std::uint64_t step_ = kNever + 1;
  ToolPose last_;  ///< in the step before; of no meaning when no point stays
};

}  // namespace

std::unique_ptr<DepthModel> make_continuous_normal_projection_depth() {
  return std::make_unique<ContinuousNormalProjectionDepth>();
}

}  // namespace hapbench
