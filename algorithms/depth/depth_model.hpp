#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Computes the penetration depth d_i >= 0 [m] and the gradient u_i of every colliding point (thesis sections B.1, C.1,
/// F.1). u_i is the unit vector from the point to where the point would leave the tool (ContactBuffer). Most models
/// depend only on the pose of the tool. A model with a memory holds the state of one run. A model costs one virtual
/// call in each step.
class DepthModel {
 public:
  virtual ~DepthModel() = default;
  /// Called before the first step. `shell` contains all points that may become contacts. Only this function may
  /// allocate.
  virtual void prepare(const PointShell& shell) { static_cast<void>(shell); }
  /// Resets the memory of the model to t = 0.
  virtual void reset() noexcept {}
  /// Writes depth and gradient of all contacts and pads the buffer. Called once in every step. The caller may omit
  /// the call in a step without contacts that follows another step without contacts. Precondition: every point lies
  /// inside the tool or on its surface.
  virtual void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
};

/// Entry of the table of depth models: documentation of a model, and the function that creates the model.
struct DepthModelEntry {
  const ModelInfo* info;
  std::unique_ptr<DepthModel> (*make)();
};

/// Returns the table of depth models.
std::span<const DepthModelEntry> depth_models();
/// Returns the entry of the depth model with this name; null if no depth model has this name.
const DepthModelEntry* find_depth_model(std::string_view name);
/// Creates the model with this name. Throws std::invalid_argument if no depth model has this name.
std::unique_ptr<DepthModel> make_depth_model(std::string_view name);

/// Contact source of a shell: a search finds the colliding points, and a depth model computes their depths and
/// gradients. With Skips::off, the depth model is called in every step. With Skips::on, it is not called in a step
/// without contacts that follows another step without contacts.
class ShellSource final : public ContactSource {
 public:
  /// Shell and tool must outlive the source. `search` must refer to this shell and this tool.
  ShellSource(const PointShell& shell, const ToolShape& tool, std::unique_ptr<ContactQuery> search,
              std::unique_ptr<DepthModel> depth_model, Skips skips = Skips::on);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return search_->capacity(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return search_->work(); }

 private:
  const ToolShape* tool_;
  std::unique_ptr<ContactQuery> search_;
  std::unique_ptr<DepthModel> depth_model_;
  Skips skips_;
  bool model_knows_of_no_contacts_ = false;  ///< true if the depth model was last called without contacts
};

}  // namespace hapbench
