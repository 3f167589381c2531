#pragma once

#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

/// The runs that a setting has to hold in, beside the scene's own.
namespace hapbench {

/// What the runs differ in that a setting has to hold in, beside the scene's own.
enum class FamilyOver { hands, seeds, speeds };
inline constexpr const char* kFamilyNames[] = {"hands", "seeds", "speeds"};

/// The scene's own run has no overrides.
struct FamilyMember {
  std::string name;  ///< for people, as in "a hand of 0.5 kg and 1000 N/m"
  std::vector<std::string> overrides = {};
};

/// How far apart seeds start [m]: less than a hand repeats a place.
inline constexpr double kSeedShift = 1e-5;
/// Starts of `seeds`, the scene's own among them.
inline constexpr int kSeeds = 5;

/// The other runs of the family; none where the scene has nothing to vary, as a hand whose force is a script.
///   hands   that are springs: the ends of hand_family(), 100 and 1000 N/m, with the damping of the scene's own; on an
///           impedance device's handle with 0.1 and 0.5 kg each
///   seeds   further seeds, started 10 um away
///   speeds  the script of hand and tool at half and twice its speed
std::vector<FamilyMember> family_of(const LoadedScenario& loaded, FamilyOver over);

}  // namespace hapbench
