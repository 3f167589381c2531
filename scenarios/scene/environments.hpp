#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/solid.hpp"

/// Environments: their fields, and the points, the inside and the springs that these say.
namespace hapbench {

/// The fields of `environment` with meaning, unit, range and default.
void describe(Fields& f, Environment& environment);

/// The environment's points, as `validate --points` writes them; null for springs. Equal ones are shared (SharedCache).
/// `files` are those of the scenario. Throws InputError when the named file cannot be used.
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario, const NamedFiles& files);
/// The same; reads the scenario's files.
inline std::shared_ptr<const PointShell> make_shell(const Scenario& scenario) {
  return make_shell(scenario, NamedFiles(scenario));
}

/// The inside of the environment's true surface, not of its shell; null for springs. Equal ones are shared.
/// `files` are those of the scenario. Throws InputError when the named file cannot be used.
std::shared_ptr<const Solid> make_solid(const Scenario& scenario, const NamedFiles& files);

/// The springs, those with random directions from the seed. Precondition: the environment is springs.
SpringSet make_springs(const Scenario& scenario);

}  // namespace hapbench
