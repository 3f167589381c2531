#include "device_model/device_presets.hpp"

namespace hapbench {
namespace {

constexpr SourcedNumber chai(double value) {
  return {value, NumberSource::chai3d};
}
constexpr SourcedNumber sheet(double value) {
  return {value, NumberSource::data_sheet};
}
constexpr SourcedNumber ours(double value) {
  return {value, NumberSource::ours};
}

// clang-format off
constexpr DevicePreset kPresets[] = {
  // name          device                         m [kg]        b [N s/m]   c [N]       q [m]            F [N]       K [N/m]     B [N s/m]
  {"touch",       "3D Systems Touch",             sheet(0.045), ours(0.1),  ours(0.2),  sheet(0.055e-3), chai(3.3),  chai(400),  chai(4)},
  {"omni",        "SensAble Phantom Omni",        ours(0.045),  ours(0.1),  ours(0.2),  ours(0.055e-3),  chai(3.3),  chai(700),  chai(5)},
  {"desktop",     "SensAble Phantom Desktop",     ours(0.045),  ours(0.1),  ours(0.06), ours(0.025e-3),  chai(7.9),  chai(1000), chai(5)},
  {"premium_1.5", "SensAble Phantom Premium 1.5", ours(0.075),  ours(0.1),  ours(0.04), ours(0.03e-3),   chai(8.5),  chai(800),  chai(5)},
  {"premium_3.0", "SensAble Phantom Premium 3.0", ours(0.16),   ours(0.2),  ours(0.2),  ours(0.02e-3),   chai(22),   chai(1000), chai(5)},
  {"falcon",      "Novint Falcon",                ours(0.1),    ours(0.5),  ours(0.5),  ours(0.06e-3),   chai(8),    chai(3000), chai(20)},
  {"omega.3",     "Force Dimension omega.3",      ours(0.2),    ours(0.5),  ours(0.3),  sheet(0.01e-3),  chai(12),   chai(5000), chai(30)},
  {"omega.6",     "Force Dimension omega.6",      ours(0.3),    ours(0.5),  ours(0.3),  ours(0.01e-3),   chai(12),   chai(5000), chai(30)},
  {"omega.7",     "Force Dimension omega.7",      ours(0.35),   ours(0.5),  ours(0.3),  ours(0.01e-3),   chai(12),   chai(5000), chai(30)},
  {"delta.3",     "Force Dimension delta.3",      ours(0.3),    ours(0.5),  ours(0.5),  ours(0.02e-3),   chai(20),   chai(5000), chai(30)},
  {"sigma.7",     "Force Dimension sigma.7",      ours(0.4),    ours(0.5),  ours(0.4),  ours(0.01e-3),   chai(12),   chai(4000), chai(30)},
  {"lambda.7",    "Force Dimension lambda.7",     ours(0.4),    ours(0.5),  ours(0.4),  ours(0.01e-3),   chai(12),   chai(8000), chai(30)},
};
// clang-format on

}  // namespace

const char* source_text(NumberSource source) noexcept {
  switch (source) {
    case NumberSource::chai3d:
      return "CHAI3D 3.3.0, src/devices/CPhantomDevices.cpp and CDeltaDevices.cpp";
    case NumberSource::data_sheet:
      return "the maker's data sheet";
    case NumberSource::ours:
      break;
  }
  return "(ours)";
}

std::span<const DevicePreset> device_presets() noexcept {
  return kPresets;
}

const DevicePreset* find_device_preset(std::string_view name) noexcept {
  for (const DevicePreset& preset : kPresets) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

ImpedanceDeviceConfig config_of(const DevicePreset& preset) {
  ImpedanceDeviceConfig config;
  config.handle_mass = preset.handle_mass.value;
  config.viscous = preset.viscous.value;
  config.coulomb = preset.coulomb.value;
  config.encoder_step = preset.encoder_step.value;
  config.force_max = preset.force_max.value;
  return config;
}

}  // namespace hapbench
