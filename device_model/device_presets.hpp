#pragma once

#include <span>
#include <string_view>

#include "device_model/impedance_device.hpp"

namespace hapbench {

/// Source of a number of a preset.
enum class NumberSource { chai3d, data_sheet, ours };

/// The source in words.
const char* source_text(NumberSource source) noexcept;

struct SourcedNumber {
  double value;
  NumberSource source;
  double low = value, high = value;  ///< what it may be as well, where it is ours
};

/// A published impedance display. Filter, delay and resolution of the force belong to its controller and are not
/// included.
struct DevicePreset {
  const char* name;
  const char* device;           ///< make and model
  SourcedNumber handle_mass;    ///< [kg]
  SourcedNumber viscous;        ///< [N s/m]
  SourcedNumber coulomb;        ///< [N]
  SourcedNumber encoder_step;   ///< [m]
  SourcedNumber force_max;      ///< [N]
  SourcedNumber max_stiffness;  ///< published largest stable stiffness of a wall [N/m]
  SourcedNumber max_damping;    ///< published largest stable damping [N s/m]
};

/// All presets, in the order of their makers.
std::span<const DevicePreset> device_presets() noexcept;
/// Null if there is no preset of that name.
const DevicePreset* find_device_preset(std::string_view name) noexcept;

/// Which of the values that a preset's unpublished numbers may have: its own, or all those that let a wall vibrate
/// sooner (little friction and mass, a coarse encoder), or later.
enum class PresetEnd { own, soft, stiff };
inline constexpr const char* kPresetRanges =
    "dry friction 0 to twice ours, viscous friction once to ten times, mass less or more by 1.3, encoder finer or coarser "
    "by 2";

/// The device, with defaults for fields that a preset does not contain.
ImpedanceDeviceConfig config_of(const DevicePreset& preset, PresetEnd end = PresetEnd::own);

}  // namespace hapbench
