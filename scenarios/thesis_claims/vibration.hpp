#pragma once

#include <string>

#include "results/summary/summary.hpp"
#include "scenarios/thesis_claims/measured.hpp"

/// How claims that one algorithm vibrates and another moves smoothly compare the two.
namespace hapbench {

/// Total variation of the velocity [m/s], power of the velocity above 30 Hz [m^2/s^2] and reversals of the force.
MeasuredCase vibration(const std::string& name, const RunSummary& summary);

/// What "vibrates" means beside "moves smoothly": this many times the total variation, and the square of it the power.
inline constexpr double kVibratesMore = 5.0;
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b);
/// More of both.
bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b);

/// The beginning of a rule.
std::string vibration_rule();
std::string vibrations_text(const Measured& cases);

}  // namespace hapbench
