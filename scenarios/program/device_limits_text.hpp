#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/studies/stability/device_limits.hpp"

/// What `compare --devices` says of the stiffness that devices can render.
namespace hapbench {

/// The bundled scenes for it; the flat wall comes first.
std::vector<std::string> default_device_scenes();

/// Of a scene among those asked: its file's.
std::string scene_name(const DeviceQuestion& question, std::size_t scene);

/// Place of a device's reference among the answers: in the first scene, with the first algorithm.
std::size_t reference_of(const DeviceQuestion& question, std::size_t device);

/// A limit over its device's reference; none where either has no value.
struct DeviceRatio {
  std::optional<double> stiffness;  ///< K over that of the reference
  std::optional<double> rendered;   ///< K lambda_max(S), the stiffness that the hand meets, over that of the reference
};
DeviceRatio ratio_of(const DeviceLimit& limit, const DeviceLimit& reference);

/// What lies beyond a limit: a class, "end of the range", or without a limit the class at its low end.
std::string beyond_text(const FieldLimit& limit);

/// The question, the table of K, that of the ratios, and a line for each of its columns.
std::string device_limits_text(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits);
/// Writes device_limits.csv and device_runs.csv. Throws IoError.
void write_device_limits(const std::filesystem::path& directory, const DeviceQuestion& question,
                         const std::vector<DeviceLimit>& limits);
Json device_limits_json(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits);

}  // namespace hapbench
