#pragma once

#include "scenarios/codec/codec.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The "motion" object of a scenario: scripted orientation, and a free, prescribed or recorded position.
CodecPtr<MotionFields> motion_codec();

}  // namespace hapbench
