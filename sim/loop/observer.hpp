#pragma once

#include <cstdint>

#include "sim/contact/stiffness_tensor.hpp"
#include "sim/loop/device.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Row k of a run: everything evaluated from (p_k, v_k, axis(t_k)), before the integrator moves the tool.
struct StepRecord {
  std::uint64_t step = 0;
  double time = 0.0;  ///< t_k = k dt [s]
  ToolState tool;
  double roll = 0.0;  ///< the tool's, also of a solid of revolution, whose pose leaves it out; filled only if wanted
  RenderedForce force;
  Vec3 hand_force = Vec3::Zero();  ///< what the hand pushes with [N]
  MeasuredForce hand;              ///< what the device makes of it
  HandleState handle;
  bool handle_moves_tool = false;           ///< the tool is where its device measures the handle; no virtual mass
  const TargetTask* task = nullptr;         ///< what the hand works on at this row; null without such a task
  std::size_t colliding = 0;                ///< colliding points before any point stage
  const ContactBuffer* rendered = nullptr;  ///< contacts the law saw; valid during on_step only
  RatioRange ratio;                         ///< over the rendered contacts; filled only if an observer wants it
  SpringState springs;                      ///< filled only if an observer wants springs or energy
  std::optional<DeviceEnergy> device;       ///< filled only if an observer wants energy

  /// Of the body that moves, virtual mass or handle [m/s]: not what encoder and filter make of it.
  const Vec3& body_velocity() const noexcept { return handle_moves_tool ? handle.velocity : tool.velocity; }
};

/// Watches a run without changing it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// True when on_step reads `ratio`; otherwise nobody computes it.
  virtual bool wants_ratio() const noexcept { return false; }
  /// True when on_step reads `roll`; otherwise nobody computes it.
  virtual bool wants_roll() const noexcept { return false; }
  /// True when on_step reads `springs` and `device`; otherwise nobody computes them.
  virtual bool wants_energy() const noexcept { return false; }
  /// True when on_step reads `springs`.
  virtual bool wants_springs() const noexcept { return wants_energy(); }
  virtual void on_step(const StepRecord& record) noexcept = 0;
};

}  // namespace hapbench
