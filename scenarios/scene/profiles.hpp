#pragma once

#include <array>
#include <string_view>

#include "scenarios/input/fields.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A field that holds a function of time with values in `unit`.
void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc,
             Presence presence = Presence::has_default);

/// Three fields that hold functions of time with values in `unit`, which are x, y and z.
void profiles(Fields& f, const char* const (&names)[3], std::array<Profile, 3>& profiles, const char* unit,
              const char* doc, Presence presence = Presence::has_default);

}  // namespace hapbench
