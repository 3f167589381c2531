#include "device_model/device_presets.hpp"

#include <gtest/gtest.h>

namespace hapbench::device_presets_test {
namespace {

TEST(DevicePresets, HaveNamesOfTheirOwnAndPossibleNumbers) {
  for (const DevicePreset& preset : device_presets()) {
    EXPECT_EQ(find_device_preset(preset.name), &preset);
    const ImpedanceDeviceConfig config = config_of(preset);
    EXPECT_GT(config.handle_mass, 0.0);
    EXPECT_GE(config.viscous, 0.0);
    EXPECT_GE(config.coulomb, 0.0);
    EXPECT_GT(config.encoder_step, 0.0);
    EXPECT_GT(config.force_max.value(), 0.0);
    EXPECT_GT(preset.max_stiffness.value, 0.0);
    EXPECT_EQ(preset.max_stiffness.source, NumberSource::chai3d);
    EXPECT_GT(preset.max_damping.value, 0.0);
  }
  EXPECT_EQ(find_device_preset("touch")->max_stiffness.value, 400.0);
  EXPECT_EQ(find_device_preset("Touch"), nullptr);
}

}  // namespace
}  // namespace hapbench::device_presets_test
