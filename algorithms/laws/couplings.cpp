#include <Eigen/Cholesky>
#include <cmath>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

/// Laws with a coupling spring between the tool and its contacts: virtual_coupling, least_squares,
/// static_coupling.
namespace hapbench {
namespace {

/// Returns the energy [J] and the moment about `tip` [N m] of springs of stiffness K [N/m] with the weights in the
/// buffer. The tool ends of the springs have moved by `shift` [m], so their depths are d_i + <u_i, shift>. O(n).
SpringState shifted_springs(const ContactBuffer& contacts, const Vec3& shift, const Vec3& tip, double K) noexcept {
  using simd::load, simd::Pack;
  const Pack sx(shift.x()), sy(shift.y()), sz(shift.z());
  const Pack tip_x(tip.x()), tip_y(tip.y()), tip_z(tip.z());
  Pack energy(0.0), mx(0.0), my(0.0), mz(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack ux = load(&contacts.ux[i]), uy = load(&contacts.uy[i]), uz = load(&contacts.uz[i]);
    const Pack d = load(&contacts.depth[i]) + (ux * sx + uy * sy + uz * sz);
    const Pack x = load(&contacts.x[i]) - tip_x, y = load(&contacts.y[i]) - tip_y, z = load(&contacts.z[i]) - tip_z;
    const Pack cd = load(&contacts.weight[i]) * d;
    energy += cd * d;
    mx += cd * (y * uz - z * uy);
    my += cd * (z * ux - x * uz);
    mz += cd * (x * uy - y * ux);
  }
  return {0.5 * K * simd::sum(energy), -K * Vec3(simd::sum(mx), simd::sum(my), simd::sum(mz))};
}

/// Base of laws in which all penalty springs act in series with one coupling spring: f = -K M^-1 sum d_i u_i and S =
/// M^-1 S_sum, with S_sum = sum u u^T and M = shift I + scale S_sum.
class SeriesLaw : public ForceLaw {
 public:
  SeriesLaw(double stiffness, double shift, double scale) : ForceLaw(stiffness), shift_(shift), scale_(scale) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    // M is positive definite, because S_sum is a sum of u u^T.
    series_.compute(shift_ * Mat3::Identity() + scale_ * S_sum);
    const Mat3 S = series_.solve(S_sum);
    // S is symmetric, because S_sum and M^-1 commute; averaging removes the rounding of the solve.
    return {-K_ * series_.solve(weighted_depth(contacts)), 0.5 * (S + S.transpose())};
  }

  bool gives_weights() const noexcept override { return false; }

  /// Returns the turning velocity of the springs without coupling, multiplied by M^-1. The coupling also multiplies the
  /// stiffness tensor S_sum by M^-1.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return series_.solve(ForceLaw::turning_velocity(contacts, S, tool));
  }

 protected:
  /// Returns energy and moment of springs of stiffness K_p [N/m] in series with a coupling. The force `spring`
  /// stretches the coupling by `stretch` [m], which reduces the depth of each penalty spring to d_i + <u_i,
  /// stretch>.
  static SpringState coupled_springs(const ContactBuffer& contacts, const Vec3& spring, const Vec3& stretch,
                                     const Vec3& tip, double K_p) noexcept {
    SpringState state = shifted_springs(contacts, stretch, tip, K_p);
    state.energy += 0.5 * spring.dot(stretch);
    return state;
  }

  double shift_, scale_;

 private:
  Eigen::LLT<Mat3> series_;  ///< factorisation of M for the last contacts
};

constexpr AlgorithmParameter kAlongSum[] = {
    {"along_sum",
     {0.0, 1.0, "1"},
     0.0,
     "0: coupling spring in space; 1: scalar coupling spring along the sum of the depths, whose direction the force "
     "keeps"}};

/// Penalty springs of stiffness K in series with a coupling spring of stiffness K_vc: M = I + K / K_vc S_sum. M
/// contains K / K_vc and not K_vc / K, so that `evaluate` needs no special case for K = 0.
class VirtualCoupling final : public SeriesLaw {
 public:
  explicit VirtualCoupling(const RenderingConfig& config)
      : SeriesLaw(config.stiffness, 1.0, config.virtual_coupling ? config.stiffness / *config.virtual_coupling : 1.0),
        along_sum_(parameter_value(config, "virtual_coupling", kAlongSum[0]) >= 0.5) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    if (!along_sum_) return SeriesLaw::evaluate(contacts);
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    const Vec3 sum = weighted_depth(contacts), u = sum.normalized();
    transmitted_ = shift_ / (shift_ + scale_ * u.dot(S_sum * u));
    return {-transmitted_ * K_ * sum, transmitted_ * S_sum};
  }

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    return K_ == 0.0 ? SpringState{} : coupled_springs(contacts, spring, spring * (scale_ / K_), tip, K_);
  }

  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    if (!along_sum_) return SeriesLaw::turning_velocity(contacts, S, tool);
    return transmitted_ * ForceLaw::turning_velocity(contacts, S, tool);  // NOLINT(bugprone-parent-virtual-call)
  }

 private:
  bool along_sum_;
  double transmitted_ = 1.0;  ///< fraction of the summed force that a scalar coupling transmits
};

/// Bound of |f_spring| / K = |(I + U U^T)^-1 U (d_1 … d_n)^T| for n contacts with depths <= d. The columns of U are the
/// gradients. (I + U U^T)^-1 U has the singular values s / (1 + s^2) <= 1/2, where s is a singular value of U. The
/// vector of the depths has the norm |(d_1 … d_n)| <= sqrt(n) d. Precondition: K_vc = K.
double virtual_coupling_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n)) * depth;
}

/// Mechanical equivalent: penalty springs of stiffness K / eps in series with one coupling spring of stiffness K. The
/// energy is E = K / (2 eps) min [sum (d_i - <u_i, x>)^2 + eps |x|^2]. The minimum is taken over x, where -x is the
/// stretch of the coupling spring. The gradient of E with respect to the tool's position is K x = -f.
class LeastSquares final : public SeriesLaw {
 public:
  explicit LeastSquares(const RenderingConfig& config) : SeriesLaw(config.stiffness, config.regularisation, 1.0) {}

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    return K_ == 0.0 ? SpringState{} : coupled_springs(contacts, spring, spring / K_, tip, K_ / shift_);
  }
};

/// Bound of |f_spring| / K = |x|, where x = (eps I + U U^T)^-1 U d. The columns of U are the gradients, and d is the
/// vector of the depths. |x| is at most |d| times the largest s / (eps + s^2) over the singular values s of U. For any
/// s, s / (eps + s^2) <= 1 / (2 sqrt(eps)). |d| is at most sqrt(n) times the largest depth.
double least_squares_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n) / config.regularisation) * depth;
}

constexpr AlgorithmParameter kSaturation[] = {
    {"saturation_N",
     {1e-6, 1e12, "N"},
     30.0,
     "F_s: largest force of the coupling spring; default: the force limit of the trainer"}};

/// Limits of Newton's method in StaticCoupling, which finds the displacement at which the forces on the copy of the
/// tool balance: number of Newton steps, and lower limit of the fraction of a Newton step that is tried. If the method
/// ends before the forces balance, the rendered force is the force of the coupling at the last displacement.
constexpr int kMaxSteps = 30;
constexpr double kMinFraction = 1e-6;
/// Lower limit that StaticCoupling sets for the stiffness of its coupling along the coupling force, relative to the
/// stiffness perpendicular to this force. Far beyond saturation, rounding would make the stiffness along the force zero
/// or negative.
constexpr double kMinStiffnessRatio = 1e-12;
/// Tolerated norm of the sum of the forces on the copy of the tool (see StaticCoupling), relative to K sqrt(sum p_i^2)
/// with the depths p_i of the contacts in the copy. The rounding error of a sum of n forces is below 1e-16 sqrt(n)
/// times K sqrt(sum p_i^2).
constexpr double kMaxImbalance = 1e-13;

double saturation_of(const RenderingConfig& config) {
  return parameter_value(config, "static_coupling", kSaturation[0]);
}

/// Static virtual coupling: the tool is connected by a saturating spring to a massless copy of itself, displaced by s
/// [m] from the tool. The forces of the spring and of the contacts on the copy balance. This balance is the minimum of
/// the convex energy
///
///   W(s) + K/2 sum p_i^2,  W(s) = F_s^2 / K_vc (sqrt(1 + (K_vc |s| / F_s)^2) - 1)
///
/// with the depths p_i of the contacts in the copy, the stiffness K_vc of the spring at s = 0 and its saturation force
/// F_s. Newton's method finds the minimum; a step that does not reduce the imbalance of the forces is halved. The
/// balance depends only on the current contacts and not on the previous step. The force is therefore the derivative of
/// a potential energy.
class StaticCoupling final : public ForceLaw {
 public:
  explicit StaticCoupling(const RenderingConfig& config)
      : ForceLaw(config), K_vc_(config.virtual_coupling.value_or(config.stiffness)), F_s_(saturation_of(config)) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    displacement_.setZero();
    transmission_.setZero();
    if (contacts.empty() || K_ == 0.0 || K_vc_ == 0.0) {
      set_weights(contacts, 0.0);
      return {};
    }
    find_balance(contacts);
    // Stiffness of the coupling and the contacts in series.
    const Mat3 springs = K_ * stiffness_tensor(contacts);
    const Mat3 coupling = coupling_stiffness(displacement_);
    transmission_ = Eigen::LDLT<Mat3>(coupling + springs).solve(coupling).transpose();
    // S is symmetric up to rounding, which averaging removes.
    const Mat3 S = transmission_ * springs / K_;
    return {coupling_force(displacement_), 0.5 * (S + S.transpose())};
  }

  SpringState spring_state(const ContactBuffer& contacts, const Vec3&, const Vec3& tip) const noexcept override {
    SpringState state = shifted_springs(contacts, displacement_, tip, K_);
    state.energy += coupling_energy(displacement_);
    return state;
  }

  bool gives_weights() const noexcept override { return false; }

  /// Returns the turning velocity of the contacts without coupling, multiplied by `transmission_`. The coupling also
  /// multiplies the stiffness tensor of the contacts by `transmission_`.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return transmission_ * ForceLaw::turning_velocity(contacts, S, tool);
  }

 private:
  /// The action of the contacts on the copy of the tool.
  struct CopyForce {
    double depth_norm = 0.0;    ///< sqrt(sum p_i^2) [m]
    Vec3 force = Vec3::Zero();  ///< contact force on the copy [N]
  };

  /// Computes the displacement s of the copy at which contact forces and coupling force balance.
  void find_balance(ContactBuffer& contacts) noexcept {
    CopyForce copy_force = force_on_copy(contacts, displacement_);
    Vec3 residual = copy_force.force - coupling_force(displacement_);
    for (int step = 0; step < kMaxSteps && residual.norm() > kMaxImbalance * K_ * copy_force.depth_norm;
         ++step, ++iterations_) {
      const Mat3 stiffness = coupling_stiffness(displacement_) + K_ * stiffness_tensor(contacts);
      const Vec3 newton = Eigen::LDLT<Mat3>(stiffness).solve(residual);
      const Vec3 from = displacement_;
      const double before = residual.norm();
      // Halve the step until the imbalance decreases. A full step may be too long if the coupling saturates or contacts
      // separate.
      for (double fraction = 1.0; fraction > kMinFraction; fraction *= 0.5) {
        displacement_ = from + fraction * newton;
        copy_force = force_on_copy(contacts, displacement_);
        residual = copy_force.force - coupling_force(displacement_);
        if (residual.norm() < before) break;
      }
      if (residual.norm() < before) continue;
      displacement_ = from;  // here the imbalance is only rounding, or no step reduces it
      force_on_copy(contacts, displacement_);
      return;
    }
  }

  double saturation(const Vec3& s) const noexcept { return std::sqrt(1.0 + (K_vc_ / F_s_ * s).squaredNorm()); }
  Vec3 coupling_force(const Vec3& s) const noexcept { return K_vc_ / saturation(s) * s; }
  /// Energy W of the coupling [J], written without a difference of nearly equal numbers.
  double coupling_energy(const Vec3& s) const noexcept { return K_vc_ * s.squaredNorm() / (1.0 + saturation(s)); }
  Mat3 coupling_stiffness(const Vec3& s) const noexcept {
    const double q = saturation(s);
    // |r|^2 = 1 - 1 / q^2, and 1 - |r|^2 is the stiffness along s relative to the stiffness perpendicular to s.
    Vec3 r = K_vc_ / (F_s_ * q) * s;
    if (const double along = r.squaredNorm(); along > 1.0 - kMinStiffnessRatio)
      r *= std::sqrt((1.0 - kMinStiffnessRatio) / along);
    return K_vc_ / q * (Mat3::Identity() - r * r.transpose());
  }

  /// Returns the contact force on a copy displaced by s [m], and sqrt(sum p_i^2). Sets the weight of each contact to 1
  /// if the copy still touches the contact, otherwise to 0. O(n).
  CopyForce force_on_copy(ContactBuffer& contacts, const Vec3& s) const noexcept {
    using simd::load, simd::Pack, simd::select;
    const Pack sx(s.x()), sy(s.y()), sz(s.z()), zero(0.0);
    Pack squares(0.0), fx(0.0), fy(0.0), fz(0.0);
    for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
      const Pack ux = load(&contacts.ux[i]), uy = load(&contacts.uy[i]), uz = load(&contacts.uz[i]);
      const Pack depth = load(&contacts.depth[i]);
      const Pack d = depth + (ux * sx + uy * sy + uz * sz);
      const Pack weight = select(d * depth > zero, Pack(1.0), zero);  // the padding has depth 0 and gets weight 0
      const Pack p = weight * d;
      simd::store(weight, &contacts.weight[i]);
      squares += p * p;
      fx += p * ux;
      fy += p * uy;
      fz += p * uz;
    }
    return {std::sqrt(simd::sum(squares)), -K_ * Vec3(simd::sum(fx), simd::sum(fy), simd::sum(fz))};
  }

  double K_vc_;                       ///< stiffness of the coupling before saturation [N/m]
  double F_s_;                        ///< saturation force of the coupling [N]
  Vec3 displacement_ = Vec3::Zero();  ///< displacement s of the copy for the last contacts [m]
  /// C (C + P)^-1 with the stiffness C of the coupling and the stiffness P of the contacts. Maps the contacts' force on
  /// a tool without coupling to the force with coupling.
  Mat3 transmission_ = Mat3::Zero();
};

/// Bound of |f_spring| / K for n contacts with depths <= d: the coupling force equals the sum of the contact forces,
/// which is at most n K d. The coupling force is also below its saturation F_s.
double static_coupling_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  const double summed = static_cast<double>(n) * depth;
  return config.stiffness > 0.0 ? std::min(summed, saturation_of(config) / config.stiffness) : summed;
}

}  // namespace

AlgorithmEntry virtual_coupling_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kVirtualCoupling, "K_vc: stiffness of the coupling spring; null: K"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "virtual_coupling",
      .summary = "all springs in series with one quasi-static coupling spring",
      .formula =
          "f = -K_vc (K_vc I + K S_sum)^-1 K sum d_i u_i, S = K_vc (K_vc I + K S_sum)^-1 S_sum, S_sum = sum u u^T; "
          "with along_sum 1, along g = sum d_i u_i only: f = -q K g, S = q S_sum, q = K_vc / (K_vc + K <u, S_sum u>), "
          "u = g / |g|",
      .source = "thesis Fig. 2d",
      .known_failure =
          "limits the stiffness, but the force still follows the direction with the largest number of points",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<VirtualCoupling>,
          .force_bound = virtual_coupling_bound,
          .algorithm_parameters = kAlongSum};
}

AlgorithmEntry least_squares_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kRegularisation,
       "eps: regularisation, which favours a short translation over an exact fit of the depths"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "least_squares",
      .summary = "one spring along the translation that fits all depths best",
      .formula =
          "x = argmin sum (d_i - <u_i, x>)^2 + eps |x|^2 = (eps I + S_sum)^-1 sum d_i u_i, f = -K x, "
          "S = (eps I + S_sum)^-1 S_sum, S_sum = sum u u^T; always without reduction",
      .source =
          "not in the thesis (Tikhonov's regularised least squares); equivalent to virtual_coupling with stiffness K "
          "/ eps",
      .known_failure =
          "with a small eps, S jumps when the first contact along a direction appears or the last one disappears, and "
          "with nearly opposite contacts, the force may reach K / (2 sqrt eps) times the norm of their depths",
      .parameters = kParameters,
  };
  return {.info = &kInfo, .make_law = law_of<LeastSquares>, .force_bound = least_squares_bound, .may_reduce = false};
}

AlgorithmEntry static_coupling_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kVirtualCoupling, "K_vc: stiffness of the coupling spring before it saturates; null: K"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "static_coupling",
      .summary =
          "a massless copy of the tool, in equilibrium between its contacts and a coupling spring that saturates",
      .formula =
          "f = g(|s|) s / |s|, g(x) = K_vc x / sqrt(1 + (K_vc x / F_s)^2), where the copy's displacement s from the "
          "tool balances -K sum p_i u_i = f; p_i = d_i + <u_i, s> if this sum has the sign of d_i, otherwise 0; S = "
          "-df/dp / K",
      .source =
          "static virtual coupling of Barbic and James, Six-DoF haptic rendering of contact between geometrically "
          "complex reduced deformable models (IEEE Trans. Haptics 1, 2008); the shape of g and the solution to "
          "convergence are not from that paper",
      .known_failure =
          "the copy follows the direction with the largest number of points, and forces beyond the saturation feel "
          "soft",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<StaticCoupling>,
          .force_bound = static_coupling_bound,
          .may_reduce = false,
          .algorithm_parameters = kSaturation};
}

}  // namespace hapbench
