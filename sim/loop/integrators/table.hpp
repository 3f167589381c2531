#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "sim/core/model_info.hpp"
#include "sim/loop/integrators/integrator.hpp"

namespace hapbench {

struct SpringDamper;
struct RaisedSpringDamper;

/// What is known of an integrator. The theory is that of one spring-damper (spring_damper.hpp); null where there is no
/// closed form, and whoever needs a number then takes it from steps of the integrator itself.
struct IntegratorEntry {
  ModelInfo info;
  std::unique_ptr<Integrator> (*make)();
  int order = 1;         ///< of convergence on undamped springs
  int damped_order = 1;  ///< and with damping
  int forces = 1;        ///< rendered forces a step, the row's and those asked for within the step
  /// True when the row's force acts unchanged over the step: M dv = f dt, so that its work needs no other force.
  bool holds_force = false;
  /// The matrix A of (x, v) -> A (x, v).
  Eigen::Matrix2d (*step_matrix)(const SpringDamper&) = nullptr;
  /// Positive exactly where a step is stable.
  double (*stability_margin)(const SpringDamper&) = nullptr;
  /// The largest stable value; infinite when there is none. None where this problem has no closed form.
  std::optional<double> (*stability_limit)(const RaisedSpringDamper&) = nullptr;
};

// The table. Each row is defined in the source file of its name; adding an integrator is that file and two lines here.
extern const IntegratorEntry kLeapfrog;
extern const IntegratorEntry kVelocityVerlet;
extern const IntegratorEntry kRk4;
extern const IntegratorEntry kImplicitEuler;
extern const IntegratorEntry kImplicitMidpoint;

inline constexpr std::array kIntegrators = {
    &kLeapfrog, &kVelocityVerlet, &kRk4, &kImplicitEuler, &kImplicitMidpoint,
};

/// Null when the table has no such name.
inline const IntegratorEntry* find_integrator(std::string_view name) noexcept {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->info.name == name) return entry;
  }
  return nullptr;
}

}  // namespace hapbench
