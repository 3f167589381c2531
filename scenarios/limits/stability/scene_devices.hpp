#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/format/load_scenario.hpp"

/// Devices that a scene is put on in place of its own: those of the program, and files.
namespace hapbench {

/// A note on a delay in samples, whose time depends on the scene's step; empty for devices without one.
std::string delay_note(const Scenario& scenario);

/// A device that a scene is tried on.
struct ComparedDevice {
  std::string name;                                ///< "ideal", "admittance", a preset's or its file's
  std::string json;                                ///< the scenario's field "device"
  bool has_place_for_mass = false;                 ///< of a hand that is fixed to the handle
  std::optional<double> published_stiffness = {};  ///< of a preset: the largest stable one of a wall [N/m]
};

/// All of them: both devices with a virtual mass as they are by default, then the presets.
std::vector<ComparedDevice> compared_devices();

/// One of a user's own, named after its file: an object with the fields of a scenario's device, or a scenario with such
/// an object as its `device`. Throws InputError with file and pointer.
ComparedDevice device_of_file(const std::filesystem::path& file);

/// The same with its dry friction times a factor, named touch[friction*2]; nothing for a device that has none.
std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor);

/// A preset with the numbers of both ends of what nobody published (PresetEnd), named touch[soft] and touch[stiff];
/// nothing for another device.
std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device);

/// The overrides that put the scene on the device, before the given ones. A hand with a mass loses it where the device
/// has no place for one; the virtual mass is there instead.
std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides);

}  // namespace hapbench
