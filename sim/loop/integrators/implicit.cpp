#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sim/loop/integrators/table.hpp"

/// Integrators that solve for the velocity at the end of the step with a linearised force,
/// f(p + dp, v + dv) = f - K dp - D dv, K and D from the algorithm's Jacobian (K S; B S and friction). A step costs one
/// 3x3 solve and the row's force. They do not foresee contacts that are absent at the row, changes of S, turns of the
/// tool or force limits. Directions in which D drives the tool (friction on a law whose S exceeds 1) are integrated as
/// by leapfrog.
namespace hapbench {
namespace {

/// Solves (M I + resistance) dv = impulse for a symmetric `resistance` [kg], the impulse in N s; finite for finite
/// arguments whose quotients by M are finite.
Vec3 velocity_change(const Mat3& resistance, const Vec3& impulse, double mass) noexcept {
  const Mat3 A = Mat3::Identity() + resistance / mass;
  const Vec3 explicit_change = impulse / mass;
  if (!A.allFinite()) return explicit_change;
  // Forces that hold the tool make every eigenvalue at least 1 up to rounding, which is nearly always the case.
  if (Eigen::LLT<Mat3>(A - 0.5 * Mat3::Identity()).info() == Eigen::Success) return A.llt().solve(explicit_change);
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(A);
  const Mat3& axes = modes.eigenvectors();
  return axes * (axes.transpose() * explicit_change).cwiseQuotient(modes.eigenvalues().cwiseMax(1.0));
}

/// (M I + dt D + dt^2 K) dv = dt (f - dt K v);  v += dv,  p += dt v.
/// Order 1. On springs and dampers it is the backward Euler method: stable for every K, B and dt; an undamped spring
/// loses the fraction k / (1 + k), k = K dt^2 / M, of its energy in every step, so that stiff springs come to rest at
/// once.
class ImplicitEuler final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const auto [K, D] = field.jacobian();
    tool.velocity += velocity_change(dt * D + dt * dt * K, dt * (force - dt * (K * tool.velocity)), mass);
    tool.pose.position += dt * tool.velocity;
  }
};

/// (M I + dt/2 D + dt^2/4 K) dv = dt (f - dt/2 K v);  p += dt (v + dv/2),  v += dv.
/// Order 2. On springs and dampers it is the implicit midpoint rule (also the trapezoidal one): stable for every K, B
/// and dt; undamped springs keep their energy up to rounding. Modes much stiffer than M / dt^2 are not damped but
/// change sign from step to step.
class ImplicitMidpoint final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const auto [K, D] = field.jacobian();
    const double half = 0.5 * dt;
    const Vec3 change = velocity_change(half * D + half * half * K, dt * (force - half * (K * tool.velocity)), mass);
    tool.pose.position += dt * (tool.velocity + 0.5 * change);
    tool.velocity += change;
  }
};

}  // namespace

const IntegratorEntry kImplicitEuler = {
    .info = {.name = "implicit_euler",
             .summary = "linearly implicit Euler: order 1, never unstable on springs, one force and one 3x3 solve a "
                        "step",
             .formula = "(M I + dt D + dt^2 K S) dv = dt (f - dt K S v); v += dv; p += v dt",
             .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations; D. Baraff and A. Witkin "
                       "1998",
             .known_failure = "takes energy out of every oscillation, all of it where K dt^2 / M is large; sees no "
                              "contact before it is there"},
    .make = make_integrator<ImplicitEuler>,
};

const IntegratorEntry kImplicitMidpoint = {
    .info = {.name = "implicit_midpoint",
             .summary = "linearly implicit midpoint rule: order 2, never unstable on springs, one force and one 3x3 "
                        "solve a step",
             .formula = "(M I + dt/2 D + dt^2/4 K S) dv = dt (f - dt/2 K S v); p += dt (v + dv/2); v += dv",
             .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations",
             .known_failure = "keeps the energy of undamped springs, so springs much stiffer than M / dt^2 swing from "
                              "step to step; sees no contact before it is there"},
    .make = make_integrator<ImplicitMidpoint>,
    .order = 2,
    .damped_order = 2,
};

}  // namespace hapbench
