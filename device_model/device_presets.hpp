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

/// The device, with defaults for fields that a preset does not contain.
ImpedanceDeviceConfig config_of(const DevicePreset& preset);

}  // namespace hapbench
