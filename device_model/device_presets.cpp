#include "device_model/device_presets.hpp"

namespace hapbench {
namespace {

constexpr SourcedNumber chai(double value) {
  return {value, NumberSource::chai3d};
}
constexpr SourcedNumber sheet(double value) {
  return {value, NumberSource::data_sheet};
}
// An estimate of an unpublished number, and the factors that bound it (kPresetRanges). They are wide: no measured
// friction of these devices was found, and a paddle whose motor's data sheet says 0.04 N s/m took 3 to 4
// (scenarios/library/validation).
constexpr SourcedNumber ours(double value, double low, double high) {
  return {value, NumberSource::ours, low * value, high * value};
}
constexpr SourcedNumber our_mass(double value) {
  return ours(value, 1.0 / 1.3, 1.3);
}
constexpr SourcedNumber our_viscous(double value) {
  return ours(value, 1.0, 10.0);
}
constexpr SourcedNumber our_coulomb(double value) {
  return ours(value, 0.0, 2.0);
}
constexpr SourcedNumber our_encoder(double value) {
  return ours(value, 0.5, 2.0);
}

// clang-format off
constexpr DevicePreset kPresets[] = {
  {.name = "touch",       .device = "3D Systems Touch",             .handle_mass = sheet(0.045), .viscous = our_viscous(0.1), .coulomb = our_coulomb(0.2),
   .encoder_step = sheet(0.055e-3), .force_max = chai(3.3), .max_stiffness = chai(400),  .max_damping = chai(4)},
  {.name = "omni",        .device = "SensAble Phantom Omni",        .handle_mass = our_mass(0.045),  .viscous = our_viscous(0.1), .coulomb = our_coulomb(0.2),
   .encoder_step = our_encoder(0.055e-3),  .force_max = chai(3.3), .max_stiffness = chai(700),  .max_damping = chai(5)},
  {.name = "desktop",     .device = "SensAble Phantom Desktop",     .handle_mass = our_mass(0.045),  .viscous = our_viscous(0.1), .coulomb = our_coulomb(0.06),
   .encoder_step = our_encoder(0.025e-3),  .force_max = chai(7.9), .max_stiffness = chai(1000), .max_damping = chai(5)},
  {.name = "premium_1.5", .device = "SensAble Phantom Premium 1.5", .handle_mass = our_mass(0.075),  .viscous = our_viscous(0.1), .coulomb = our_coulomb(0.04),
   .encoder_step = our_encoder(0.03e-3),   .force_max = chai(8.5), .max_stiffness = chai(800),  .max_damping = chai(5)},
  {.name = "premium_3.0", .device = "SensAble Phantom Premium 3.0", .handle_mass = our_mass(0.16),   .viscous = our_viscous(0.2), .coulomb = our_coulomb(0.2),
   .encoder_step = our_encoder(0.02e-3),   .force_max = chai(22),  .max_stiffness = chai(1000), .max_damping = chai(5)},
  {.name = "falcon",      .device = "Novint Falcon",                .handle_mass = our_mass(0.1),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.5),
   .encoder_step = our_encoder(0.06e-3),   .force_max = chai(8),   .max_stiffness = chai(3000), .max_damping = chai(20)},
  {.name = "omega.3",     .device = "Force Dimension omega.3",      .handle_mass = our_mass(0.2),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.3),
   .encoder_step = sheet(0.01e-3),  .force_max = chai(12),  .max_stiffness = chai(5000), .max_damping = chai(30)},
  {.name = "omega.6",     .device = "Force Dimension omega.6",      .handle_mass = our_mass(0.3),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.3),
   .encoder_step = our_encoder(0.01e-3),   .force_max = chai(12),  .max_stiffness = chai(5000), .max_damping = chai(30)},
  {.name = "omega.7",     .device = "Force Dimension omega.7",      .handle_mass = our_mass(0.35),   .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.3),
   .encoder_step = our_encoder(0.01e-3),   .force_max = chai(12),  .max_stiffness = chai(5000), .max_damping = chai(30)},
  {.name = "delta.3",     .device = "Force Dimension delta.3",      .handle_mass = our_mass(0.3),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.5),
   .encoder_step = our_encoder(0.02e-3),   .force_max = chai(20),  .max_stiffness = chai(5000), .max_damping = chai(30)},
  {.name = "sigma.7",     .device = "Force Dimension sigma.7",      .handle_mass = our_mass(0.4),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.4),
   .encoder_step = our_encoder(0.01e-3),   .force_max = chai(12),  .max_stiffness = chai(4000), .max_damping = chai(30)},
  {.name = "lambda.7",    .device = "Force Dimension lambda.7",     .handle_mass = our_mass(0.4),    .viscous = our_viscous(0.5), .coulomb = our_coulomb(0.4),
   .encoder_step = our_encoder(0.01e-3),   .force_max = chai(12),  .max_stiffness = chai(8000), .max_damping = chai(30)},
};
// clang-format on

}  // namespace

const char* source_text(NumberSource source) noexcept {
  if (source == NumberSource::chai3d) return "CHAI3D 3.3.0, src/devices/CPhantomDevices.cpp and CDeltaDevices.cpp";
  return source == NumberSource::data_sheet ? "the maker's data sheet" : "(ours)";
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

ImpedanceDeviceConfig config_of(const DevicePreset& preset, PresetEnd end) {
  const auto at = [end](const SourcedNumber& number) {
    return end == PresetEnd::own ? number.value : end == PresetEnd::soft ? number.low : number.high;
  };
  ImpedanceDeviceConfig config;
  config.handle_mass = at(preset.handle_mass);
  config.viscous = at(preset.viscous);
  config.coulomb = at(preset.coulomb);
  const SourcedNumber& step = preset.encoder_step;
  config.encoder_step = end == PresetEnd::own ? step.value : end == PresetEnd::soft ? step.high : step.low;
  config.force_max = preset.force_max.value;
  return config;
}

}  // namespace hapbench
