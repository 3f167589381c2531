#include <tuple>
#include <utility>

#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// The integrator that the thesis calls leapfrog (Eq. A.1), which is semi-implicit, symplectic Euler:
/// v += (force / mass) dt, then p += v dt. Stable on one spring-damper while 4 - 2 B dt / M - K dt^2 / M > 0.
class Leapfrog final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField&) noexcept override {
    tool.velocity += force / mass * dt;
    tool.pose.position += tool.velocity * dt;
  }
};

/// Eq. A.2.
Eigen::Matrix2d step_matrix(const SpringDamper& s) {
  const double k = s.lambda * s.K * s.dt / s.M, b = s.lambda * s.B * s.dt / s.M;
  Eigen::Matrix2d A;
  A << 1.0 - k * s.dt, s.dt - b * s.dt, -k, 1.0 - b;
  return A;
}

double margin(const SpringDamper& s) {
  return 4.0 - 2.0 * s.lambda * s.B * s.dt / s.M - s.lambda * s.K * s.dt * s.dt / s.M;
}

/// Velocity Verlet: half a kick with the row's force, drift, half a kick with the force at the new position and the
/// velocity after the first half:
///
///   v_half = v + f/M dt/2,  p += v_half dt,  v = v_half + f(t + dt, p, v_half)/M dt/2
///
/// Order 2 without damping, order 1 with damping, which sees velocities of half a step before. With k = K dt^2 / M,
/// b = B dt / M and c = 1 - b/2 it is stable on one spring-damper while b < 4 and k (1 + c) < 4 (1 + c^2): k < 4 for
/// B = 0, as with leapfrog, and b < 4 for K = 0, twice as far. Symplectic on undamped springs: the energy swings by a
/// fraction of k/4 about its value and does not drift. Two forces a step, because the next row needs the force at the
/// final velocity.
class VelocityVerlet final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const Vec3 half = tool.velocity + force / mass * (0.5 * dt);
    tool.pose.position += half * dt;
    tool.velocity = half + field.force_at(1.0, tool.pose.position, half) / mass * (0.5 * dt);
  }
};

/// A piece of a step by the classical Runge-Kutta method of order 4: from the part `from` of the step of dt on, `h`
/// long [s], with the force at its begin. Calls `stage` after each force but the first. Returns position and velocity.
template <class Stage>
std::pair<Vec3, Vec3> runge_kutta(const Vec3& p, const Vec3& v1, const Vec3& force, double mass, double from, double h,
                                  double dt, ForceField& field, const Stage& stage) noexcept {
  const double half = 0.5 * h;
  const auto acceleration = [&](double time, const Vec3& position, const Vec3& velocity) {
    const Vec3 a = field.force_at(from + time / dt, position, velocity) / mass;
    stage();
    return a;
  };
  const Vec3 a1 = force / mass;
  const Vec3 v2 = v1 + a1 * half, a2 = acceleration(half, p + v1 * half, v2);
  const Vec3 v3 = v1 + a2 * half, a3 = acceleration(half, p + v2 * half, v3);
  const Vec3 v4 = v1 + a3 * h, a4 = acceleration(h, p + v3 * h, v4);
  return {p + (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (h / 6.0), v1 + (a1 + 2.0 * a2 + 2.0 * a3 + a4) * (h / 6.0)};
}

/// The classical Runge-Kutta method of order 4 (the axis at t, t + dt/2 and t + dt), the reference for smooth forces;
/// contacts that come and go within a step, and the held force f_in, reduce it to order 1.
///
/// An undamped spring is stable while K dt^2 / M < 8 and loses the fraction (K dt^2 / M)^3 / 72 of its energy in a
/// step. A damper alone is stable while B dt / M < 2.7853. Four forces a step.
class Rk4 final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    std::tie(tool.pose.position, tool.velocity) =
        runge_kutta(tool.pose.position, tool.velocity, force, mass, 0.0, dt, dt, field, [] {});
  }
};

/// Rk4 in pieces in which the same contacts act: where a piece meets a contact on or off, it is halved until it is
/// shorter than the tolerance, and the next piece begins behind the event. A reference for how contacts begin and end:
/// the energy that an explicit step creates there is of first order in the step, here in the tolerance. f_in is held.
///
/// Each event costs about 10 log2(dt / tolerance) forces. A step of more than kMostPieces goes on without looking.
class Event final : public Integrator {
 public:
  explicit Event(const IntegratorOptions& options) : tolerance_(options.tolerance) {}

  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    constexpr int kMostPieces = 10'000;
    Vec3 acting = force;
    std::uint64_t set = field.contact_set();
    double done = 0.0, h = dt;
    for (int piece = 0; done < dt; ++piece) {
      const bool last = h >= dt - done;
      if (last) h = dt - done;
      bool same = true;
      const auto look = [&] { same = same && field.contact_set() == set; };
      const auto [p, v] = runge_kutta(tool.pose.position, tool.velocity, acting, mass, done / dt, h, dt, field, look);
      const double end = last ? 1.0 : (done + h) / dt;
      const Vec3 force_then = field.force_at(end, p, v);
      look();
      if (!same && h > tolerance_ && piece < kMostPieces) {
        h *= 0.5;
        continue;
      }
      tool.pose.position = p;
      tool.velocity = v;
      acting = force_then;
      set = field.contact_set();
      done = last ? dt : done + h;
      if (!same) h = dt;  // behind the event
    }
  }

 private:
  double tolerance_;
};

/// The end of the stability region |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 on the real axis.
constexpr double kRk4Damper = 2.785293563405282;

}  // namespace

const IntegratorEntry kLeapfrog = {
    .info = {.name = "leapfrog",
             .summary = "semi-implicit Euler, the thesis's integrator: order 1, one force a step",
             .formula = "v += f/M dt; p += v dt",
             .source = "thesis Eq. A.1",
             .known_failure = "blows up where 4 - 2 B dt / M - K dt^2 / M < 0; the energy of an undamped spring swings "
                              "but does not drift"},
    .make = make_integrator<Leapfrog>,
    .holds_force = true,
    .step_matrix = step_matrix,
    .stability_margin = margin,
    .damper_limit = 2.0,
};

const IntegratorEntry kVelocityVerlet = {
    .info = {.name = "velocity_verlet",
             .summary = "half a kick, drift, half a kick: order 2 without damping, two forces a step",
             .formula = "v' = v + f/M dt/2; p += v' dt; v = v' + f(p, v')/M dt/2",
             .source = "L. Verlet 1967, W. C. Swope et al. 1982",
             .known_failure = "no stiffer springs than leapfrog without damping, K < 4 M / dt^2; order 1 with damping"},
    .make = make_integrator<VelocityVerlet>,
    .order = 2,
    .forces = 2,
    .damper_limit = 4.0,
};

const IntegratorEntry kRk4 = {
    .info = {.name = "rk4",
             .summary = "classical Runge-Kutta method, the reference on smooth forces: order 4, four forces a step",
             .formula = "v, p += dt/6 (k1 + 2 k2 + 2 k3 + k4)",
             .source = "W. Kutta 1901",
             .known_failure =
                 "blows up at K > 8 M / dt^2; order 1 where contacts come and go within a step; dissipates a little"},
    .make = make_integrator<Rk4>,
    .order = 4,
    .damped_order = 4,
    .forces = 4,
    .damper_limit = kRk4Damper,
};

const IntegratorEntry kEvent = {
    .info = {.name = "event",
             .summary = "rk4 in pieces between contacts on and off, which it finds inside a step: a reference",
             .formula = "rk4 from event to event; events to tolerance_s by halving",
             .source = "ours; event location as in L. F. Shampine, S. Thompson 2000",
             .known_failure = "slow where many points touch and leave: some hundred forces for each of them; "
                              "blows up at K > 8 M / dt^2"},
    .make = make_integrator<Event>,
    .order = 4,
    .damped_order = 4,
    .forces = 5,
    .damper_limit = kRk4Damper,
};

}  // namespace hapbench
