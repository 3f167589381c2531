#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The "device" object of a scenario, chosen by "type".
CodecPtr<DeviceFields> device_codec();

}  // namespace hapbench
