#include "sim/loop/integrators/table.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <tuple>
#include <utility>

namespace hapbench {
namespace {

/// The integrator that the thesis calls leapfrog (Eq. A.1). It is semi-implicit (symplectic) Euler.
void leapfrog(ToolState& tool, const Vec3& force, double mass, double dt, ForceField&, double) noexcept {
  tool.velocity += force / mass * dt;
  tool.pose.position += tool.velocity * dt;
}

/// Returns the matrix of a leapfrog step, thesis Eq. A.2.
Eigen::Matrix2d step_matrix(const SpringDamper& s) {
  const double k = s.lambda * s.K * s.dt / s.M, b = s.lambda * s.B * s.dt / s.M;
  Eigen::Matrix2d A;
  A << 1.0 - k * s.dt, s.dt - b * s.dt, -k, 1.0 - b;
  return A;
}

/// Returns the stability margin of leapfrog, which is positive if and only if a step is stable.
double leapfrog_margin(const SpringDamper& s) {
  return 4.0 - 2.0 * s.lambda * s.B * s.dt / s.M - s.lambda * s.K * s.dt * s.dt / s.M;
}

/// Velocity Verlet: a half kick (velocity change over half a step) with the force at the start of the step, a
/// drift over the whole step, and a half kick with the force at the new position and the velocity after the
/// first half kick. Damping therefore uses a velocity that is half a step old.
///
/// Stability on one spring-damper, with k = K dt^2 / M, b = B dt / M and c = 1 - b/2: b < 4 and k (1 + c) < 4 (1 +
/// c^2). For B = 0 the condition is k < 4, as for leapfrog. For K = 0 the condition is b < 4, twice the limit of
/// leapfrog. Symplectic on undamped springs: the energy oscillates by up to the fraction k/4 and does not drift.
/// Evaluates the force twice in each step, because the next step needs the force at the final velocity.
void velocity_verlet(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double) noexcept {
  const Vec3 half = tool.velocity + force / mass * (0.5 * dt);
  tool.pose.position += half * dt;
  tool.velocity = half + field.force_at(1.0, tool.pose.position, half) / mass * (0.5 * dt);
}

/// Advances position and velocity by an interval of `h` [s] with the classical Runge-Kutta method of order 4. The
/// interval starts at the fraction `from` of the step of `dt` [s]. `force` is the force at the start of the interval.
/// Calls `stage` after each further evaluation of the force. Returns position and velocity at the end of the interval.
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

/// The classical Runge-Kutta method of order 4, which evaluates the force at t, t + dt/2 and t + dt, each with the tool
/// axis at this time. Reference for smooth forces. Two effects reduce its order to 1: contacts that begin or end within
/// a step, and the input force f_in, which is held over each step.
///
/// Stable on an undamped spring while K dt^2 / M < 8. Each step then loses the fraction (K dt^2 / M)^3 / 72 of
/// the energy.
void rk4(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double) noexcept {
  std::tie(tool.pose.position, tool.velocity) =
      runge_kutta(tool.pose.position, tool.velocity, force, mass, 0.0, dt, dt, field, [] {});
}

/// Runge-Kutta of order 4 with event location. The step is split into intervals in which the set of contacts is
/// constant. If a contact begins or ends within an interval, the interval is halved until it is shorter than
/// the tolerance, and the next interval begins after the event. Reference for the onset and release of contacts. At
/// such an event, the energy error of other explicit integrators is proportional to the step size; the energy error
/// of this method is proportional to the tolerance. f_in is held over the step.
///
/// Each event costs about 10 log2(dt / tolerance) force evaluations. After kMaxIntervals intervals, the step continues
/// without locating events.
void event(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double tolerance) noexcept {
  constexpr int kMaxIntervals = 10'000;
  Vec3 acting = force;
  std::uint64_t set = field.contact_set();
  double done = 0.0, h = dt;
  for (int interval = 0; done < dt; ++interval) {
    const bool last = h >= dt - done;
    if (last) h = dt - done;
    // Try an interval and check at every stage whether the set of contacts is still the same.
    bool same = true;
    const auto check_contacts = [&] { same = same && field.contact_set() == set; };
    const auto [p, v] =
        runge_kutta(tool.pose.position, tool.velocity, acting, mass, done / dt, h, dt, field, check_contacts);
    const double end = last ? 1.0 : (done + h) / dt;
    const Vec3 force_then = field.force_at(end, p, v);
    check_contacts();
    // Halve the interval if it contains an event.
    if (!same && h > tolerance && interval < kMaxIntervals) {
      h *= 0.5;
      continue;
    }
    // Accept the interval.
    tool.pose.position = p;
    tool.velocity = v;
    acting = force_then;
    set = field.contact_set();
    done = last ? dt : done + h;
    if (!same) h = dt;  // after the event, try the rest of the step as one interval
  }
}

/// B dt / M at which rk4 becomes unstable on a damper without a spring: the end of the stability region
/// |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 on the negative real axis.
constexpr double kRk4DamperLimit = 2.785293563405282;

// The implicit integrators solve for the velocity at the end of the step with a linearised force, f(p + dp, v + dv) =
// f - K dp - D dv. K and D are stiffness and damping of the algorithm's Jacobian. A step costs one 3x3 solve and the
// force at its start. The linearisation ignores contacts that begin within the step, changes of the stiffness tensor S,
// rotation of the tool, and force limits. In directions in which D adds energy (friction with a law whose S has
// eigenvalues above 1) the step equals a step of leapfrog.

/// Returns the velocity change dv [m/s] from (M I + resistance) dv = impulse, with a symmetric `resistance`
/// [kg] and the impulse in N s. The result is finite if the arguments and their quotients by M are finite.
Vec3 velocity_change(const Mat3& resistance, const Vec3& impulse, double mass) noexcept {
  const Mat3 A = Mat3::Identity() + resistance / mass;
  const Vec3 explicit_change = impulse / mass;
  if (!A.allFinite()) return explicit_change;
  // Solve directly if all eigenvalues of A exceed 0.5. Usually they are at least 1 up to rounding, because the forces
  // resist motion.
  if (Eigen::LLT<Mat3>(A - 0.5 * Mat3::Identity()).info() == Eigen::Success) return A.llt().solve(explicit_change);
  // Otherwise replace eigenvalues below 1 by 1, which treats these directions explicitly.
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(A);
  const Mat3& axes = modes.eigenvectors();
  return axes * (axes.transpose() * explicit_change).cwiseQuotient(modes.eigenvalues().cwiseMax(1.0));
}

/// Linearly implicit Euler. On springs and dampers it is the backward Euler method, which is stable for every
/// K, B and dt. An undamped spring loses the fraction k / (1 + k) of its energy in every step, k = K dt^2 / M,
/// so stiff springs come to rest at once.
void implicit_euler(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double) noexcept {
  const auto [K, D] = field.jacobian();
  tool.velocity += velocity_change(dt * D + dt * dt * K, dt * (force - dt * (K * tool.velocity)), mass);
  tool.pose.position += dt * tool.velocity;
}

/// Linearly implicit midpoint rule, identical to the trapezoidal rule on springs and dampers. It is stable for
/// every K, B and dt. Undamped springs keep their energy up to rounding. Modes much stiffer than M / dt^2 are
/// not damped; they change sign in every step.
void implicit_midpoint(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double) noexcept {
  const auto [K, D] = field.jacobian();
  const double half = 0.5 * dt;
  const Vec3 change = velocity_change(half * D + half * half * K, dt * (force - half * (K * tool.velocity)), mass);
  tool.pose.position += dt * (tool.velocity + 0.5 * change);
  tool.velocity += change;
}

/// A linear force plus a force that is held over the step.
class LinearField final : public ForceField {
 public:
  LinearField(const LinearForce& force, const Vec3& held) : force_(force), held_(held) {}

  Vec3 force_at(double, const Vec3& position, const Vec3& velocity) noexcept override {
    return held_ - force_.stiffness * position - force_.damping * velocity;
  }
  ForceJacobian jacobian() const noexcept override { return force_.assumed; }

 private:
  LinearForce force_;
  Vec3 held_;
};

/// Returns the tool after one step from position x and velocity v, under a linear force and a held force [N].
ToolState stepped(const IntegratorEntry& integrator, double M, double dt, const LinearForce& force, const Vec3& x,
                  const Vec3& v, const Vec3& held) {
  LinearField field(force, held);
  ToolState tool;
  tool.pose.position = x;
  tool.velocity = v;
  integrator.step(tool, field.force_at(0.0, x, v), M, dt, field, kEventTolerance);
  return tool;
}

/// Returns (x, v) after one step from (x, v), under a held force [N].
Eigen::Vector2d stepped(const SpringDamper& s, double x, double v, double held) {
  const Mat3 K = s.lambda * s.K * Mat3::Identity(), B = s.lambda * s.B * Mat3::Identity();
  const Vec3 axis = Vec3::UnitX();
  const ToolState tool = stepped(*s.integrator, s.M, s.dt, {K, B, {K, B}}, x * axis, v * axis, held * axis);
  return {tool.pose.position.x(), tool.velocity.x()};
}

}  // namespace

const IntegratorEntry kLeapfrog = {
    .info =
        {.name = "leapfrog",
         .summary = "semi-implicit Euler, the thesis's integrator: order 1, one force evaluation per step",
         .formula = "v += f/M dt; p += v dt",
         .source = "thesis Eq. A.1",
         .known_failure =
             "unstable if 4 - 2 B dt / M - K dt^2 / M < 0; the energy of an undamped spring oscillates but does not "
             "drift"},
    .step = leapfrog,
    .holds_force = true,
    .step_matrix = step_matrix,
    .stability_margin = leapfrog_margin,
    .damper_limit = 2.0,
};

const IntegratorEntry kVelocityVerlet = {
    .info = {.name = "velocity_verlet",
             .summary = "half a kick, drift, half a kick: order 2 without damping, two force evaluations per step",
             .formula = "v' = v + f/M dt/2; p += v' dt; v = v' + f(p, v')/M dt/2",
             .source = "L. Verlet 1967, W. C. Swope et al. 1982",
             .known_failure = "without damping, stable only for K < 4 M / dt^2, like leapfrog; order 1 with damping"},
    .step = velocity_verlet,
    .order = 2,
    .damper_limit = 4.0,
};

const IntegratorEntry kRk4 = {
    .info =
        {.name = "rk4",
         .summary =
             "classical Runge-Kutta method, the reference on smooth forces: order 4, four force evaluations per step",
         .formula = "v, p += dt/6 (k1 + 2 k2 + 2 k3 + k4)",
         .source = "W. Kutta 1901",
         .known_failure =
             "unstable if K > 8 M / dt^2; order 1 if contacts begin or end within a step; dissipates a little energy"},
    .step = rk4,
    .order = 4,
    .damped_order = 4,
    .damper_limit = kRk4DamperLimit,
};

const IntegratorEntry kEvent = {
    .info =
        {.name = "event",
         .summary = "rk4 between the times within a step at which contacts begin or end: a reference",
         .formula = "rk4 from event to event; the time of an event is found by bisection to tolerance_s",
         .source = "ours; event location as in L. F. Shampine, S. Thompson 2000",
         .known_failure =
             "slow if many contacts begin and end: some hundred force evaluations for each event; unstable if K > 8 M "
             "/ dt^2"},
    .step = event,
    .order = 4,
    .damped_order = 4,
    .damper_limit = kRk4DamperLimit,
};

const IntegratorEntry kImplicitEuler = {
    .info =
        {.name = "implicit_euler",
         .summary =
             "linearly implicit Euler: order 1, never unstable on springs, one force evaluation and one 3x3 solve per "
             "step",
         .formula = "(M I + dt D + dt^2 K S) dv = dt (f - dt K S v); v += dv; p += v dt",
         .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations; D. Baraff and A. Witkin "
                   "1998",
         .known_failure =
             "dissipates energy of every oscillation, nearly all of it if K dt^2 / M is large; does not anticipate a "
             "contact that begins within the step"},
    .step = implicit_euler,
};

const IntegratorEntry kImplicitMidpoint = {
    .info =
        {.name = "implicit_midpoint",
         .summary =
             "linearly implicit midpoint rule: order 2, never unstable on springs, one force evaluation and one 3x3 "
             "solve per step",
         .formula = "(M I + dt/2 D + dt^2/4 K S) dv = dt (f - dt/2 K S v); p += dt (v + dv/2); v += dv",
         .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations",
         .known_failure =
             "keeps the energy of undamped springs, so springs much stiffer than M / dt^2 oscillate from step to step; "
             "does not anticipate a contact that begins within the step"},
    .step = implicit_midpoint,
    .order = 2,
    .damped_order = 2,
};

Eigen::Matrix<double, 6, 9> step_map(const IntegratorEntry& integrator, double M, double dt, const LinearForce& force) {
  Eigen::Matrix<double, 6, 9> map;
  for (Eigen::Index i = 0; i < 9; ++i) {
    const Eigen::Matrix<double, 9, 1> unit = Eigen::Matrix<double, 9, 1>::Unit(i);
    const ToolState tool = stepped(integrator, M, dt, force, unit.head<3>(), unit.segment<3>(3), unit.tail<3>());
    map.col(i) << tool.pose.position, tool.velocity;
  }
  return map;
}

Eigen::Matrix2d SpringDamper::step_matrix() const {
  if (integrator->step_matrix != nullptr) return integrator->step_matrix(*this);
  Eigen::Matrix2d A;
  A << stepped(*this, 1.0, 0.0, 0.0), stepped(*this, 0.0, 1.0, 0.0);
  return A;
}

Eigen::Vector2d SpringDamper::input_step() const {
  return stepped(*this, 0.0, 0.0, 1.0);
}

bool SpringDamper::is_stable() const {
  constexpr double kRounding = 1e-12;
  const Eigen::Matrix2d A = step_matrix();
  const double trace = A.trace(), determinant = A.determinant();
  return std::abs(determinant) <= 1.0 + kRounding && std::abs(trace) <= 1.0 + determinant + kRounding;
}

}  // namespace hapbench
