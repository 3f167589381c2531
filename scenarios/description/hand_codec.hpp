#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The "hand" object of a scenario, chosen by "type".
CodecPtr<HandFields> hand_codec();

}  // namespace hapbench
