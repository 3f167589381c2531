#pragma once

#include "scenarios/codec/codec.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The "hand" object of a scenario, chosen by "type".
CodecPtr<HandFields> hand_codec();

}  // namespace hapbench
