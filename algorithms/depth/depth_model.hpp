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

/// Gives every colliding point its penetration depth d_i [m] >= 0 and its gradient u_i (thesis B.1, C.1, F.1; see
/// ContactBuffer for the signs). Most models depend on the pose of the tool alone; one with a memory is the state of
/// one run. One virtual call per step.
class DepthModel {
 public:
  virtual ~DepthModel() = default;
  /// Called before the first step with the contacts of a shell; the only call that may allocate.
  virtual void prepare(const PointShell& shell) { static_cast<void>(shell); }
  /// Back to t = 0.
  virtual void reset() noexcept {}
  /// Fills depth and gradient of all contacts and pads. Called once in every step; of consecutive steps without
  /// contacts, all but the first may be left out. Precondition: every point lies in the tool (closed set).
  virtual void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
};

struct DepthModelEntry {
  const ModelInfo* info;
  std::unique_ptr<DepthModel> (*make)();
};

/// The table of depth models.
std::span<const DepthModelEntry> depth_models();
/// Null if there is no model of that name.
const DepthModelEntry* find_depth_model(std::string_view name);
/// Throws std::invalid_argument for an unknown name.
std::unique_ptr<DepthModel> make_depth_model(std::string_view name);

/// The points of a shell as contacts: a search finds them, a depth model gives them depth and gradient. In consecutive
/// steps without contacts the depth model is called in the first only (Skips).
class ShellSource final : public ContactSource {
 public:
  /// Shell and tool must outlive the source and the search, which refers to them.
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
  bool model_knows_of_no_contacts_ = false;  ///< the depth model's last call had no contacts
};

}  // namespace hapbench
