#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The "motion" object of a scenario: scripted orientation, and a free, prescribed or recorded position.
CodecPtr<MotionFields> motion_codec();

}  // namespace hapbench
