#pragma once

#include "scenarios/codec/codec.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The "device" object of a scenario, chosen by "type".
CodecPtr<DeviceFields> device_codec();

}  // namespace hapbench
