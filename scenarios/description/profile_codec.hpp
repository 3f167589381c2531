#pragma once

#include "scenarios/description/codec.hpp"
#include "sim/core/profile.hpp"

namespace hapbench {

/// A profile: a number, or an object of type ramp, sine or waypoints. `unit` is that of the value.
CodecPtr<Profile> profile(const char* unit);

}  // namespace hapbench
