#pragma once

#include "sim/loop/integrators/table.hpp"

namespace hapbench::test {

/// One step of leapfrog, which needs no force but the row's.
inline void leapfrog(ToolState& tool, const Vec3& force, double mass, double dt) {
  class NoField final : public ForceField {
   public:
    Vec3 force_at(double, const Vec3&, const Vec3&) noexcept override { return Vec3::Zero(); }
    ForceJacobian jacobian() const noexcept override { return {}; }
  } field;
  kLeapfrog.make()->step(tool, force, mass, dt, field);
}

}  // namespace hapbench::test
