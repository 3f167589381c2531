#pragma once

#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

/// Sets of scene variants (hands, seeds, speeds). A setting must be feasible in every variant.
namespace hapbench {

/// Names of the variant sets, which add runs to the run of the scene itself:
///   hands   hand stiffnesses of 100 and 1000 N/m (the extremes of typical_hands()) with the scene's damping;
///           a hand with a mass also gets masses of 0.1 and 0.5 kg
///   seeds   four further seeds, with start positions shifted by 10 um, less than the repeatability of a hand
///   speeds  the scripts of hand and tool at half and twice their speed
inline constexpr const char* kFamilies[] = {"hands", "seeds", "speeds"};

/// A variant of a scene.
struct SceneVariant {
  std::string name;                         ///< name for the user, such as "a hand of 0.5 kg and 1000 N/m"
  std::vector<std::string> overrides = {};  ///< overrides that make the variant; empty: the scene itself
  std::string family = {};                  ///< element of kFamilies; empty for the scene itself
};

/// Returns the variants of a set. Empty if the scene has nothing to vary; for example, a hand whose force follows a
/// script has no stiffness to vary. Precondition: `family` is an element of kFamilies.
std::vector<SceneVariant> scene_variants(const LoadedScenario& loaded, const std::string& family);

}  // namespace hapbench
