#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

/// Devices that replace the device of a scene: built-in devices, presets, and devices from files.
namespace hapbench {

/// Returns a note for the user if the device has a delay given in samples: the duration of this delay depends on the
/// scene's time step. Returns an empty text for all other devices.
std::string delay_note(const Scenario& scenario);

/// A device that replaces the scene's device.
struct ComparedDevice {
  std::string name;                                ///< "ideal", "admittance", or the name of a preset or file
  Json json;                                       ///< value of the scenario's field "device"
  bool has_place_for_mass = false;                 ///< true if a scene with this device may have a hand with a mass
  std::optional<double> published_stiffness = {};  ///< published largest stable wall stiffness [N/m]; presets only
};

/// Returns the devices "ideal" and "admittance" with their default values, followed by all presets.
std::vector<ComparedDevice> compared_devices();

/// Reads a device from a JSON file and names it after the file. The file is either a device object, with the fields of
/// a scenario's "device", or a scenario with a "device". Throws InputError with file and pointer.
ComparedDevice device_of_file(const std::filesystem::path& file);

/// Returns the device with its dry friction scaled by `factor`, with a name such as touch[friction*2]. Empty for a
/// device without dry friction.
std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor);

/// Returns a preset twice, at both ends of the ranges of its unpublished parameters (PresetVariant), with names such as
/// touch[soft] and touch[stiff]. Empty for other devices.
std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device);

/// Returns the overrides that replace the scene's device, followed by the given overrides. If the device has no place
/// for the hand's mass (!has_place_for_mass), also replaces the hand by the same hand without a mass: the virtual mass
/// of the scene represents the hand's mass. In this case, overrides of the hand's mass are dropped.
std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides);

}  // namespace hapbench
