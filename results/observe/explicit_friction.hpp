#pragma once

#include <cstdint>
#include <optional>

#include "sim/loop/integrators/table.hpp"

namespace hapbench {

/// How often a run left the range in which its integrator can step its friction. Friction is viscous with the
/// coefficient mu_s + mu_f |f_spring|, a damper that a stiff law makes as strong as it likes; an explicit integrator is
/// stable on a damper up to some B only (leapfrog: 2 M / dt). Beyond, each step turns the sliding velocity round and
/// makes it larger: what follows is the integrator's doing, not the law's.
struct ExplicitFriction {
  double limit = 0.0;                            ///< largest |f_spring| whose friction is stepped stably [N]
  std::uint64_t rows_beyond = 0;                 ///< with a larger one
  std::optional<std::uint64_t> first_step = {};  ///< of those rows
};

/// That limit, (B_max - mu_s) / mu_f with the largest B_max that the integrator steps stably, for a tool of `mass` [kg]
/// under friction mu_s [N s/m], mu_f [s/m]. Zero when mu_s alone is too much; none when no force is too large: without
/// mu_f, or where the integrator is stable on every damper.
std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f);

}  // namespace hapbench
