#pragma once

#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

/// Families of runs, in each of which a setting has to hold.
namespace hapbench {

/// The families of runs besides the scene's own run:
///   hands   springs with the scene's damping: the ends of hand_family(), 100 and 1000 N/m, on an impedance device's
///           handle with 0.1 and 0.5 kg each
///   seeds   four further seeds, with starts 10 um away, which is less than a hand's repeatability
///   speeds  the script of hand and tool at half and twice its speed
inline constexpr const char* kFamilies[] = {"hands", "seeds", "speeds"};

struct FamilyMember {
  std::string name;                         ///< in words, such as "a hand of 0.5 kg and 1000 N/m"
  std::vector<std::string> overrides = {};  ///< empty: the scene's own run
};

/// Returns the members of a family. Empty if the scene has nothing to vary, such as a hand whose force is a script.
/// Precondition: `family` is one of kFamilies.
std::vector<FamilyMember> family_of(const LoadedScenario& loaded, const std::string& family);

}  // namespace hapbench
