#include "algorithms/depth/depth_model.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/core/simd.hpp"
#include "sim/tool/motion.hpp"
#include "sim/tool/refuse.hpp"

/// The depth models, each with its documentation, and the contact source that applies a depth model.
namespace hapbench {
namespace {

constexpr ModelInfo kShortestDistanceInfo = {
    .name = "shortest_distance",
    .summary = "distance to the nearest surface of the tool, with the gradient towards it",
    .formula = "d = |q - x|, u = (q - x) / d, with q the point of the tool's surface nearest to x",
    .source =
        "thesis B.1; uses the smallest depth >= 0 (the printed formula allows negative depths, which would pull the "
        "tool in)",
    .known_failure = "the gradient flips by 180 degrees when a point crosses the tool's median line (thesis B.3.1)",
};

class ShortestDistance final : public DepthModel {
 public:
  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    tool.shortest_depths(pose, contacts);
    tool.shortest_gradients(pose, contacts);
    contacts.pad();
  }
};

constexpr ModelInfo kSurfaceNormalInfo = {
    .name = "surface_normal",
    .summary = "depth of shortest_distance, gradient against the surface normal (default)",
    .formula = "d as in shortest_distance, u = -n",
    .source = "thesis C.1, 2.3",
    .known_failure =
        "underestimates the depth; on a flat surface the depth saturates at half the tool's width (thesis C.1, F.1)",
};

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

constexpr ModelInfo kNormalProjectionInfo = {
    .name = "normal_projection",
    .summary = "distance from the point to the tool's surface along the inverse surface normal",
    .formula = "u = -n, d = smallest d > 0 at which the ray x + d u leaves the tool (a cylinder: F.7, F.9, F.12)",
    .source = "thesis F.1 (F.6 printed with a minus; F.7 shows that r_p + d r_n is meant)",
    .known_failure =
        "a point that appears at a corner can start with a large depth, so that the force jumps (Fig. F.4)",
};

class NormalProjection final : public DepthModel {
 public:
  void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.set_gradient(i, -contacts.normal(i));
    tool.exit_distances(pose, contacts, contacts.depth.data());
    contacts.pad();
  }
};

constexpr ModelInfo kContinuousNormalProjectionInfo = {
    .name = "continuous_normal_projection",
    .summary = "starts as the shortest distance, then follows the tool's motion along the gradient up to its exit",
    .formula =
        "u = -n, d = d_sd when the point enters, then d <- min(d_np, max(d_sd, d + <dx, u>)); d_sd of "
        "shortest_distance, d_np of normal_projection, dx = dp + rotation x (x - p), the displacement of the tool at "
        "the point x",
    .source =
        "thesis F.1 names the jump (Fig. F.4) and two remedies with their flaws; this remedy is not in the thesis",
    .known_failure =
        "depends on the path: a point entered from the side is only as deep as the shortest distance; a point that "
        "leaves to the side still loses its whole depth at once",
};

/// Normal projection without its force jump at corners (thesis F.1, Fig. F.4). The model stores the depth d of each
/// point and updates it in every step: d = min(max(d_sd, previous d + <dx, u>), d_np), and d = min(d_sd, d_np) when the
/// point enters. d_sd is the shortest distance to the tool's surface, d_np the normal projection, u the gradient, and
/// dx the displacement of the tool at the point in one step.
///
///  - No depth grows by more than |dx| in a step. This also holds for the step in which a point enters: relative to
///    the tool, the point has moved by dx, so d_sd <= |dx|. The depths of a tool at rest do not drift.
///  - A motion of the tool along u changes d_np by the same amount. A point that the tool has pressed along u
///    since first contact therefore has d = d_np, also beyond the tool's median line, where d_sd saturates.
///  - The increase by <dx, u> stores the work that is done against the force -K d u. Energy is created only where
///    d = d_sd; the depth model surface_normal, in which always d = d_sd, has the same fault. If a point leaves the
///    tool sideways, some energy is lost.
///
/// A depth that depends only on the pose cannot be both continuous and free of saturation. Continuity at entry requires
/// depth 0 everywhere on the tool's surface. Without saturation, a point that was pressed through the whole tool would
/// have the tool's diameter as depth when it reaches the opposite surface. Subtracting from d_np its value at entry is
/// no solution: while a tool slides over a flat surface, points enter it from the side all the time, and the tool would
/// lose its support. O(n).
class ContinuousNormalProjection final : public DepthModel {
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
      // Rounding may make the depth of a point on the surface slightly negative.
      const double shortest = std::max(contacts.depth[i], 0.0);
      point = {std::min(std::max(shortest, pressed), exit_[i]), step_};
      contacts.depth[i] = point.depth;
    }
    contacts.pad();
    last_ = pose;
  }

 private:
  static constexpr std::uint64_t kNever = 0;

  struct Memory {
    double depth = 0.0;           ///< d [m] in this step
    std::uint64_t step = kNever;  ///< last step in which the point was inside the tool
  };

  std::vector<Memory> memory_;  ///< one entry for each point of the shell
  std::vector<double> exit_;    ///< d_np of each contact [m]
  std::uint64_t step_ = kNever + 1;
  ToolPose last_;  ///< pose in the last `evaluate`; read only for points that were inside the tool at this pose
};

template <class Model>
std::unique_ptr<DepthModel> make() {
  return std::make_unique<Model>();
}

constexpr DepthModelEntry kDepthModels[] = {
    {&kShortestDistanceInfo, make<ShortestDistance>},
    {&kSurfaceNormalInfo, make<SurfaceNormal>},
    {&kNormalProjectionInfo, make<NormalProjection>},
    {&kContinuousNormalProjectionInfo, make<ContinuousNormalProjection>},
};

}  // namespace

std::span<const DepthModelEntry> depth_models() {
  return kDepthModels;
}

const DepthModelEntry* find_depth_model(std::string_view name) {
  const auto* found = std::ranges::find(kDepthModels, name, [](const auto& entry) { return entry.info->name; });
  return found == std::end(kDepthModels) ? nullptr : found;
}

std::unique_ptr<DepthModel> make_depth_model(std::string_view name) {
  if (const DepthModelEntry* entry = find_depth_model(name)) return entry->make();
  refuse("unknown depth model ", name);
}

ShellSource::ShellSource(const PointShell& shell, const ToolShape& tool, std::unique_ptr<ContactQuery> search,
                         std::unique_ptr<DepthModel> depth_model, Skips skips)
    : tool_(&tool), search_(std::move(search)), depth_model_(std::move(depth_model)), skips_(skips) {
  depth_model_->prepare(shell);
}

void ShellSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  search_->contacts_at(pose, contacts);
  if (contacts.empty() && model_knows_of_no_contacts_ && skips_ == Skips::on) return;
  depth_model_->evaluate(*tool_, pose, contacts);
  model_knows_of_no_contacts_ = contacts.empty();
}

void ShellSource::reset() noexcept {
  search_->reset();
  depth_model_->reset();
  model_knows_of_no_contacts_ = false;
}

}  // namespace hapbench
