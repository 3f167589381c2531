#pragma once

#include <cstdint>
#include <optional>

#include "sim/contact/contact_buffer.hpp"
#include "sim/loop/device.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Row k of a run: everything evaluated from (p_k, v_k, axis(t_k)), before the integrator moves the tool.
struct StepRecord {
  std::uint64_t step = 0;
  double time = 0.0;  ///< t_k = k dt [s]
  ToolState tool;
  double roll = 0.0;  ///< of the tool, even if round, in which case its pose omits it; filled only if wanted
  RenderedForce force;
  Vec3 hand_force = Vec3::Zero();  ///< of the hand on the handle [N]
  MeasuredForce hand;              ///< hand_force as measured by the device
  HandleState handle;
  bool handle_moves_tool = false;           ///< the tool follows the measured handle; there is no virtual mass
  const TargetTask* task = nullptr;         ///< of the hand at this row; null without such a task
  std::size_t colliding = 0;                ///< colliding points before any point stage
  const ContactBuffer* rendered = nullptr;  ///< contacts seen by the law; valid during on_step only
  const ContactBuffer* found = nullptr;     ///< contacts before any point stage; null unless an observer wants them
  RatioRange ratio;                         ///< over the rendered contacts; filled only if an observer wants it
  SpringState springs;                      ///< filled only if an observer wants springs or energy
  std::optional<DeviceEnergy> device;       ///< filled only if an observer wants energy

  /// True velocity of the moving body, virtual mass or handle [m/s], without the effects of encoder and filter.
  const Vec3& body_velocity() const noexcept { return handle_moves_tool ? handle.velocity : tool.velocity; }
};

/// Watches a run without changing it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// True if on_step reads `ratio`, which is otherwise not computed.
  virtual bool wants_ratio() const noexcept { return false; }
  /// True if on_step reads `roll`, which is otherwise not computed.
  virtual bool wants_roll() const noexcept { return false; }
  /// True if on_step reads `springs` and `device`, which are otherwise not computed.
  virtual bool wants_energy() const noexcept { return false; }
  /// True if on_step reads `springs`.
  virtual bool wants_springs() const noexcept { return wants_energy(); }
  /// True if on_step reads `found`, which is otherwise not kept.
  virtual bool wants_found() const noexcept { return false; }
  virtual void on_step(const StepRecord& record) noexcept = 0;
};

}  // namespace hapbench
