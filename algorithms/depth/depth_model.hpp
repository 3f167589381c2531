#pragma once

#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Gives every colliding point its penetration depth d_i [m] >= 0 and its gradient u_i (thesis B.1, C.1, F.1; see
/// ContactBuffer for the signs). Most depend on the tool's pose alone; one with a memory is the state of one run. One
/// virtual call per step.
class DepthModel {
 public:
  virtual ~DepthModel() = default;
  /// Before the first step with the contacts of a shell; the only call that may allocate.
  virtual void prepare(const PointShell& shell) { static_cast<void>(shell); }
  /// Back to t = 0.
  virtual void reset() noexcept {}
  /// Fills depth and gradient of all contacts and pads. Precondition: every point lies in the tool (closed set). Called
  /// once in every step; of several steps on end without contacts, all but the first may be left out.
  virtual void evaluate(const ToolShape& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
};

}  // namespace hapbench
