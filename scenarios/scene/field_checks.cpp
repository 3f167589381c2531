#include "scenarios/scene/field_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

void require_direction(const Vec3& direction, const std::string& at) {
  if (direction.norm() >= kShortestDirection) return;
  fail_at(at, fmt::format("got [{}]; allowed: a direction that is not zero, length at least {}",
                          fmt::join(direction, ", "), kShortestDirection));
}

void require_at_most(double most, double count, const std::string& at, const char* what) {
  if (!(count <= most)) fail_at(at, fmt::format("got {:.3g} {}; allowed: at most {:.0g}", count, what, most));
}

}  // namespace hapbench
