#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

/// Devices that replace the device of a scene: the presets of the program, and devices of files.
namespace hapbench {

/// Returns a note on a delay in samples, whose time depends on the scene's step; empty for devices without one.
std::string delay_note(const Scenario& scenario);

/// A device that a scene is run on.
struct ComparedDevice {
  std::string name;                                ///< "ideal", "admittance", the name of a preset or of a file
  Json json;                                       ///< the scenario's field "device"
  bool has_place_for_mass = false;                 ///< a hand that is fixed to the handle may have a mass
  std::optional<double> published_stiffness = {};  ///< of a preset: published largest stable stiffness of a wall [N/m]
};

/// Returns all devices of the program: the two devices with a virtual mass, with their defaults, then the presets.
std::vector<ComparedDevice> compared_devices();

/// Reads a device from a file and names it after the file. The file has an object with the fields of a scenario's
/// device, or a scenario with such an object as its `device`. Throws InputError with file and pointer.
ComparedDevice device_of_file(const std::filesystem::path& file);

/// Returns the device with its dry friction times a factor, named such as touch[friction*2]; empty for a device without
/// dry friction.
std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor);

/// Returns a preset at both ends of its unpublished parameters (PresetEnd), named such as touch[soft] and touch[stiff];
/// empty for other devices.
std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device);

/// Returns the overrides that put the scene on the device, followed by the given overrides. The hand's mass is dropped
/// if the device has no place for it: the virtual mass represents it.
std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides);

}  // namespace hapbench
