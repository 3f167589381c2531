#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/loop/device.hpp"

/// Haptic devices: description of their fields, and construction of the simulated device.
namespace hapbench {

/// Describes the fields of `device` with meaning, unit, range and default.
void describe(Fields& f, DeviceFields& device);

/// Converts the delay of an impedance device from seconds to time steps. Does nothing if the scenario gives no
/// delay in seconds. Throws InputError if the scenario also gives a different number of time steps, or if the
/// delay is longer than 10 000 time steps.
void resolve_delay(Scenario& scenario);

/// Returns the device of the scenario, with the random seeds of the trial.
std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial);

}  // namespace hapbench
