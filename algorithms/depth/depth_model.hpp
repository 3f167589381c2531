#pragma once

#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// Gives every colliding point its penetration depth d_i [m] >= 0 and its gradient u_i (thesis B.1, C.1, F.1; see
/// ContactBuffer for the signs). Stateless; one virtual call per step.
class DepthModel {
 public:
  virtual ~DepthModel() = default;
  /// Fills depth and gradient of all contacts and pads. Precondition: every point lies in the tool (closed set).
  virtual void evaluate(const Tool& tool, const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
};

}  // namespace hapbench
