#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/solid.hpp"

/// Environments: description of their fields, and construction of their point shell, solid or springs.
namespace hapbench {

/// Describes the fields of `environment` with meaning, unit, range and default.
void describe(Fields& f, Environment& environment);

/// Returns the environment's point shell, which `validate --points` writes to a file; null for springs. Scenarios
/// with equal environments share the shell (SharedCache). `files` are the scenario's files. Throws InputError if
/// the environment's file cannot be used.
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario, const NamedFiles& files);
/// Returns the result of make_shell() above with a new object of the scenario's files. These files are read again, also
/// if the caller has read them before.
inline std::shared_ptr<const PointShell> make_shell(const Scenario& scenario) {
  return make_shell(scenario, NamedFiles(scenario));
}

/// Returns the solid that the environment's exact surface bounds; null for springs. The solid does not depend on the
/// sampling of the shell. Exception: the solid of a point-shell file is computed from the file's points, because the
/// file has no other surface. Environments from equal files share the solid (SharedCache). `files` are the scenario's
/// files. Throws InputError if the environment's file cannot be used.
std::shared_ptr<const Solid> make_solid(const Scenario& scenario, const NamedFiles& files);

/// Returns the springs of the environment. Random directions depend on the scenario's seed. Precondition: the
/// environment has the type SpringsEnvironment.
SpringSet make_springs(const Scenario& scenario);

}  // namespace hapbench
