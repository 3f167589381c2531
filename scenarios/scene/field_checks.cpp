#include "scenarios/scene/field_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

void require_direction(const Vec3& direction, const std::string& at) {
  if (direction.norm() >= kMinDirectionNorm) return;
  fail_at(at, fmt::format("got [{}]; allowed: a direction that is not zero, length at least {}",
                          fmt::join(direction, ", "), kMinDirectionNorm));
}

void require_at_most(double max, double count, const std::string& at, const char* what) {
  if (!(count <= max)) fail_at(at, fmt::format("got {:.3g} {}; allowed: at most {:.0g}", count, what, max));
}

}  // namespace hapbench
