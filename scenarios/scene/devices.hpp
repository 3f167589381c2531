#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/loop/device.hpp"

/// Haptic devices: their fields, and the device that these say.
namespace hapbench {

/// The fields of `device` with meaning, unit, range and default.
void describe(Fields& f, DeviceFields& device);

/// Makes samples of a device's delay in seconds. Throws InputError where given samples say something else.
void resolve_delay(Scenario& scenario);

std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial);

}  // namespace hapbench
