#include "scenarios/run/force_warnings.hpp"

#include <fmt/format.h>

namespace hapbench {

std::vector<std::string> force_warnings(const Metrics& metrics) {
  std::vector<std::string> warnings;
  if (const auto& friction = metrics.explicit_friction; friction && friction->first_step) {
    warnings.push_back(fmt::format(
        "beyond {:.3g} N of spring force, in {} of {} rows, first in step {}, the explicit step of friction is unstable; "
        "what follows is the integrator's doing, not the law's",
        friction->limit, friction->rows_beyond, metrics.rows, *friction->first_step));
  }
  if (const auto& jumps = metrics.reduction; jumps && jumps->stand_out()) {
    warnings.push_back(fmt::format(
        "reduction: kept points change in {} of {} steps, force steps up to {:.2g} N there and {:.2g} N elsewhere; "
        "rendering.reduction=null keeps them all",
        jumps->changes, metrics.rows, jumps->step_max().value_or(0.0), jumps->step_max_elsewhere()));
  }
  return warnings;
}

}  // namespace hapbench
