#pragma once

#include <array>
#include <string_view>

#include "scenarios/input/fields.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Describes a field that holds a profile, which is a scalar function of time. `unit` is the unit of its values.
void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc,
             Presence presence = Presence::has_default);

/// Describes three fields that hold the x, y and z components of a vector as functions of time. `unit` is the
/// unit of their values.
void profiles(Fields& f, const char* const (&names)[3], std::array<Profile, 3>& profiles, const char* unit,
              const char* doc, Presence presence = Presence::has_default);

}  // namespace hapbench
