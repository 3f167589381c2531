#pragma once

#include "scenarios/format/fields.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/scenario.hpp"

/// The description of a scenario file: every field with its meaning, unit, range and default.
namespace hapbench {

/// Range of the lengths in a scene.
inline constexpr NumberRange kLength = {0.0, 1000.0, "m", true};
/// Throws InputError at `at` when the direction is shorter than 1e-12.
void require_direction(const Vec3& direction, const std::string& at);

// Objects.
void describe(Fields& f, Scenario& scenario);
void describe(Fields& f, MotionFields& motion);
void describe(Fields& f, RenderingConfig& rendering);

// Objects whose type chooses the fields.
void describe(Fields& f, Environment& environment);
void describe(Fields& f, PositionFields& position);
void describe(Fields& f, HandFields& hand);
void describe(Fields& f, DeviceFields& device);
void describe(Fields& f, ToolFields& tool);

/// A field that holds a function of time with values in `unit`.
void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc,
             Presence presence = Presence::has_default);

/// Three of them, which are x, y and z.
void profiles(Fields& f, const char* const (&names)[3], std::array<Profile, 3>& profiles, const char* unit,
              const char* doc, Presence presence = Presence::has_default);

/// Makes samples of a device's delay in seconds, once both device and time step are there. Throws InputError where the
/// samples are given too and say something else.
void resolve_delay(Scenario& scenario);

/// The types of tools, in the variant's order.
std::vector<std::string> tool_names();

/// Warnings, each beginning with a JSON pointer, about values without effect in `json`, from which the scenario was
/// read: a device's loop that no hand feels, and the first script of waypoints of hand and motion whose last leg begins
/// only when the run is over. A shorter time step with the same number of steps does that unnoticed.
std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json);

}  // namespace hapbench
