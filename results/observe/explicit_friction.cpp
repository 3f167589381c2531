#include "results/observe/explicit_friction.hpp"

#include <algorithm>
#include <cmath>

#include "sim/loop/integrators/spring_damper.hpp"

namespace hapbench {

std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f) {
  if ((mu_s == 0.0 && mu_f == 0.0) || integrator.stability_limit == nullptr) return std::nullopt;
  RaisedSpringDamper damper{.raised = StabilityCase::damping_alone, .given = {}, .damping = {}};
  damper.given.M = mass;
  damper.given.dt = dt;
  damper.given.integrator = &integrator;
  const std::optional<double> largest = integrator.stability_limit(damper);
  if (!largest || !std::isfinite(*largest)) return std::nullopt;
  if (mu_s >= *largest) return 0.0;
  return mu_f > 0.0 ? std::optional((*largest - mu_s) / mu_f) : std::nullopt;
}

}  // namespace hapbench
