#include "scenarios/description/integrator_infos.hpp"

#include "sim/loop/integrators/integrator.hpp"

namespace hapbench {
namespace {

constexpr ModelInfo kInfos[] = {
    {"leapfrog", "semi-implicit Euler, the thesis's integrator: order 1, one force a step", "v += f/M dt; p += v dt",
     "thesis Eq. A.1",
     "blows up where 4 - 2 B dt / M - K dt^2 / M < 0; the energy of an undamped spring swings but does not drift"},
    {"velocity_verlet", "half a kick, drift, half a kick: order 2 without damping, two forces a step",
     "v' = v + f/M dt/2; p += v' dt; v = v' + f(p, v')/M dt/2", "L. Verlet 1967, W. C. Swope et al. 1982",
     "no stiffer springs than leapfrog without damping, K < 4 M / dt^2; order 1 with damping"},
    {"rk4", "classical Runge-Kutta method, the reference on smooth forces: order 4, four forces a step",
     "v, p += dt/6 (k1 + 2 k2 + 2 k3 + k4)", "W. Kutta 1901",
     "blows up at K > 8 M / dt^2; order 1 where contacts come and go within a step; dissipates a little"},
    {"implicit_euler",
     "linearly implicit Euler: order 1, never unstable on springs, one force and one 3x3 solve a step",
     "(M I + dt D + dt^2 K S) dv = dt (f - dt K S v); v += dv; p += v dt",
     "J. C. Butcher, Numerical Methods for Ordinary Differential Equations; D. Baraff and A. Witkin 1998",
     "takes energy out of every oscillation, all of it where K dt^2 / M is large; sees no contact before it is there"},
    {"implicit_midpoint",
     "linearly implicit midpoint rule: order 2, never unstable on springs, one force and one 3x3 solve a step",
     "(M I + dt/2 D + dt^2/4 K S) dv = dt (f - dt/2 K S v); p += dt (v + dv/2); v += dv",
     "J. C. Butcher, Numerical Methods for Ordinary Differential Equations",
     "keeps the energy of undamped springs, so springs much stiffer than M / dt^2 swing from step to step; sees no "
     "contact before it is there"},
};
static_assert(std::size(kInfos) == kIntegrators.size());

}  // namespace

std::span<const ModelInfo> integrator_infos() {
  return kInfos;
}

}  // namespace hapbench
