#pragma once

#include <string>
#include <vector>

#include "scenarios/studies/stability/map_scenes.hpp"

/// A map of a device and a hand of one's own: overrides `path=value` (as of `--set`) of time.step_s and of the fields
/// of `device` and `hand`, or of either as a whole, in every scene of a map of an impedance device. What an axis varies
/// stays the axis's where the whole device is given.
namespace hapbench {

/// Throws InputError for a map without an impedance device or whose axes are in units of its own one, for a field that
/// is none of these or that an axis varies, and for a value that the field does not take.
void require_overridable(const StabilityMap& map, const std::vector<std::string>& overrides);

/// A scene of the map with the overrides; only its time step, device and hand change. Precondition: require_overridable
/// accepts them.
Scenario with_overrides(const StabilityMap& map, Scenario scenario, const std::vector<std::string>& overrides);

}  // namespace hapbench
