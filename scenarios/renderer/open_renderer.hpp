#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "device_model/live/live_renderer.hpp"
#include "scenarios/run/checked_scenario.hpp"

/// Definition of the type that is opaque in the C interface (hapbench_renderer.h): the renderer and the texts that the
/// C functions return.
struct HapbenchRenderer {
  hapbench::LiveRenderer live;
  std::string inspection;  ///< text of hapbench_renderer_inspect
  std::string log_header;  ///< text of hapbench_renderer_log_header
};

namespace hapbench {

/// Settings that the caller gives for a renderer, besides the scenario.
struct RendererSetup {
  std::uint32_t mode = HAPBENCH_IMPEDANCE;
  std::uint32_t flags = 0;
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
};

/// Throws InputError if the mount in `setup` (the pose and scale of the device in the scene) has a value that is not
/// allowed.
void check_mount(const RendererSetup& setup);

/// Throws InputError if the period of the loop, which is the scenario's time step, is not smaller than stale_s of the
/// mount: calls would be late, and the renderer would never render a force. A replay does not need this check,
/// because the times of its calls are recorded.
void check_period(const Scenario& scenario, const RendererSetup& setup);

/// Opens a renderer. Throws InputError if the scenario cannot be rendered in the mode that `setup` selects.
/// Precondition: check_mount().
HapbenchRenderer* new_renderer(const CheckedScenario& checked, const RendererSetup& setup);

/// Returns the name of a mode as in logs: "impedance" or "admittance".
const char* mode_name(std::uint32_t mode);

}  // namespace hapbench
