#include <Eigen/Cholesky>
#include <cmath>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

/// Laws with a coupling spring between the tool and its contacts: virtual_coupling, least_squares and static_coupling.
namespace hapbench {
namespace {

/// Energy and moment about `tip` of springs of stiffness K [N/m] with the weights in the buffer, whose ends have moved
/// by `shift` [m], so the depths are d_i + <u_i, shift>. O(n).
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

/// f = -K M^-1 sum d_i u_i, S = M^-1 S_sum with M = shift I + scale S_sum, S_sum = sum u u^T.
class SeriesLaw : public ForceLaw {
 public:
  SeriesLaw(double stiffness, double shift, double scale) : ForceLaw(stiffness), shift_(shift), scale_(scale) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    // Positive definite, because S_sum is a sum of u u^T.
    series_.compute(shift_ * Mat3::Identity() + scale_ * S_sum);
    const Mat3 S = series_.solve(S_sum);
    // S_sum and the inverse commute, so S is symmetric; averaging removes the rounding of the solve.
    return {-K_ * series_.solve(weighted_depth(contacts)), 0.5 * (S + S.transpose())};
  }

  bool gives_weights() const noexcept override { return false; }

  /// The coupling passes velocities on as it does depths.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return series_.solve(ForceLaw::turning_velocity(contacts, S, tool));
  }

 protected:
  /// Springs of penalty stiffness K_p [N/m] and a coupling that the force `spring` stretches by `stretch` [m], which
  /// relieves every penalty spring: depth d_i + <u_i, stretch>.
  static SpringState springs(const ContactBuffer& contacts, const Vec3& spring, const Vec3& stretch, const Vec3& tip,
                             double K_p) noexcept {
    SpringState state = shifted_springs(contacts, stretch, tip, K_p);
    state.energy += 0.5 * spring.dot(stretch);
    return state;
  }

  double shift_, scale_;

 private:
  Eigen::LLT<Mat3> series_;  ///< of M of the last contacts
};

constexpr OwnParameter kAlongSum[] = {
    {"along_sum",
     {0.0, 1.0, "1"},
     0.0,
     "0: coupling spring in space; 1: scalar coupling spring along the sum of the depths, whose direction the force "
     "keeps"}};

/// The formula divided by K_vc, so that K = 0 needs no case of its own.
class VirtualCoupling final : public SeriesLaw {
 public:
  explicit VirtualCoupling(const RenderingConfig& config)
      : SeriesLaw(config.stiffness, 1.0, config.virtual_coupling ? config.stiffness / *config.virtual_coupling : 1.0),
        along_sum_(own_value(config, "virtual_coupling", kAlongSum[0]) >= 0.5) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    if (!along_sum_) return SeriesLaw::evaluate(contacts);
    set_weights(contacts, 1.0);
    const Mat3 S_sum = stiffness_tensor(contacts);
    const Vec3 sum = weighted_depth(contacts), u = sum.normalized();
    passed_ = shift_ / (shift_ + scale_ * u.dot(S_sum * u));
    return {-passed_ * K_ * sum, passed_ * S_sum};
  }

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    return K_ == 0.0 ? SpringState{} : springs(contacts, spring, spring * (scale_ / K_), tip, K_);
  }

  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return along_sum_ ? Vec3(passed_ * ForceLaw::turning_velocity(contacts, S, tool))
                      : SeriesLaw::turning_velocity(contacts, S, tool);
  }

 private:
  bool along_sum_;
  double passed_ = 1.0;  ///< part of the sum that a scalar coupling passes on
};

/// (I + U U^T)^-1 U has the singular values s / (1 + s^2) <= 1/2, and |(d_1 … d_n)| <= sqrt(n) d.
/// Precondition: K_vc = K.
double virtual_coupling_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n)) * depth;
}

/// The energy of the law is that of its mechanical equivalent: penalty springs of stiffness K / eps in series with one
/// coupling spring of stiffness K. E = K / (2 eps) min over x of sum (d_i - <u_i, x>)^2 + eps |x|^2; its gradient with
/// respect to the position of the tool is K x = -f. Depths and velocities are resolved alike.
class LeastSquares final : public SeriesLaw {
 public:
  explicit LeastSquares(const RenderingConfig& config) : SeriesLaw(config.stiffness, config.regularisation, 1.0) {}

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    return K_ == 0.0 ? SpringState{} : springs(contacts, spring, spring / K_, tip, K_ / shift_);
  }
};

/// x = (eps I + U U^T)^-1 U d with the gradients in the columns of U. By the singular values s of U,
/// |x| <= max s / (eps + s^2) |d|, at most 1 / (2 sqrt eps) where s^2 = eps, and |d| <= sqrt(n) times the deepest.
double least_squares_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  return 0.5 * std::sqrt(static_cast<double>(n) / config.regularisation) * depth;
}

constexpr OwnParameter kSaturation[] = {
    {"saturation_N",
     {1e-6, 1e12, "N"},
     30.0,
     "F_s: largest force of the coupling spring; default: the force limit of the trainer"}};

/// Most Newton steps, and the smallest part of one. If they end before the balance, the force is still that of the
/// coupling.
constexpr int kMostSteps = 30;
constexpr double kSmallestPart = 1e-6;
/// Least stiffness of the coupling along its force, relative to that across it. Far beyond saturation rounding would
/// make it zero or negative.
constexpr double kSoftest = 1e-12;
/// Tolerated imbalance, relative to K sqrt(sum p_i^2). The rounding of the sum of n pulls is below 1e-16 sqrt(n) of it.
constexpr double kBalanced = 1e-13;

double saturation_of(const RenderingConfig& config) {
  return own_value(config, "static_coupling", kSaturation[0]);
}

/// Finds the balance by Newton's method with halved steps. It is the minimum of a convex energy,
///
///   W(s) + K/2 sum p_i^2,  W(s) = F_s^2 / K_vc (sqrt(1 + (K_vc |s| / F_s)^2) - 1),
///
/// and does not depend on the step before, so every force is the derivative of one potential of the contacts.
class StaticCoupling final : public ForceLaw {
 public:
  explicit StaticCoupling(const RenderingConfig& config)
      : ForceLaw(config), K_vc_(config.virtual_coupling.value_or(config.stiffness)), F_s_(saturation_of(config)) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    shift_.setZero();
    pass_.setZero();
    if (contacts.empty() || K_ == 0.0 || K_vc_ == 0.0) {
      set_weights(contacts, 0.0);
      return {};
    }
    find_balance(contacts);
    const Mat3 springs = K_ * stiffness_tensor(contacts);
    const Mat3 coupling = coupling_stiffness(shift_);
    pass_ = Eigen::LDLT<Mat3>(coupling + springs).solve(coupling).transpose();
    // Coupling and contacts in series; symmetric, but for the rounding that averaging removes.
    const Mat3 S = pass_ * springs / K_;
    return {coupling_force(shift_), 0.5 * (S + S.transpose())};
  }

  SpringState spring_state(const ContactBuffer& contacts, const Vec3&, const Vec3& tip) const noexcept override {
    SpringState state = shifted_springs(contacts, shift_, tip, K_);
    state.energy += coupling_energy(shift_);
    return state;
  }

  bool gives_weights() const noexcept override { return false; }

  /// The coupling passes velocities on as it does depths.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override {
    return pass_ * ForceLaw::turning_velocity(contacts, S, tool);
  }

 private:
  /// The action of the contacts on the copy.
  struct Pull {
    double pressed = 0.0;       ///< root of the sum of the squares of p_i [m]
    Vec3 force = Vec3::Zero();  ///< [N]
  };

  void find_balance(ContactBuffer& contacts) noexcept {
    Pull pull = pull_at(contacts, shift_);
    Vec3 residual = pull.force - coupling_force(shift_);
    for (int step = 0; step < kMostSteps && residual.norm() > kBalanced * K_ * pull.pressed; ++step, ++iterations_) {
      const Mat3 stiffness = coupling_stiffness(shift_) + K_ * stiffness_tensor(contacts);
      const Vec3 newton = Eigen::LDLT<Mat3>(stiffness).solve(residual);
      const Vec3 from = shift_;
      const double before = residual.norm();
      // A whole step may go too far where the coupling saturates or contacts separate.
      for (double part = 1.0; part > kSmallestPart; part *= 0.5) {
        shift_ = from + part * newton;
        pull = pull_at(contacts, shift_);
        residual = pull.force - coupling_force(shift_);
        if (residual.norm() < before) break;
      }
      if (residual.norm() < before) continue;
      shift_ = from;  // rounding is all that is left, or the balance is out of reach
      pull_at(contacts, shift_);
      return;
    }
  }

  double stretch(const Vec3& s) const noexcept { return std::sqrt(1.0 + (K_vc_ / F_s_ * s).squaredNorm()); }
  Vec3 coupling_force(const Vec3& s) const noexcept { return K_vc_ / stretch(s) * s; }
  /// W, written without the cancellation in its difference.
  double coupling_energy(const Vec3& s) const noexcept { return K_vc_ * s.squaredNorm() / (1.0 + stretch(s)); }
  Mat3 coupling_stiffness(const Vec3& s) const noexcept {
    const double q = stretch(s);
    Vec3 r = K_vc_ / (F_s_ * q) * s;  // |r|^2 = 1 - 1 / q^2; 1 - |r|^2 is the relative stiffness along s
    if (const double along = r.squaredNorm(); along > 1.0 - kSoftest) r *= std::sqrt((1.0 - kSoftest) / along);
    return K_vc_ / q * (Mat3::Identity() - r * r.transpose());
  }

  /// The pull on a copy displaced by s. Contacts that the copy still touches get the weight 1, others 0. O(n).
  Pull pull_at(ContactBuffer& contacts, const Vec3& s) const noexcept {
    using simd::load, simd::Pack, simd::select;
    const Pack sx(s.x()), sy(s.y()), sz(s.z()), zero(0.0);
    Pack squares(0.0), fx(0.0), fy(0.0), fz(0.0);
    for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
      const Pack ux = load(&contacts.ux[i]), uy = load(&contacts.uy[i]), uz = load(&contacts.uz[i]);
      const Pack depth = load(&contacts.depth[i]);
      const Pack d = depth + (ux * sx + uy * sy + uz * sz);
      const Pack weight = select(d * depth > zero, Pack(1.0), zero);  // the padding has no depth
      const Pack p = weight * d;
      simd::store(weight, &contacts.weight[i]);
      squares += p * p;
      fx += p * ux;
      fy += p * uy;
      fz += p * uz;
    }
    return {std::sqrt(simd::sum(squares)), -K_ * Vec3(simd::sum(fx), simd::sum(fy), simd::sum(fz))};
  }

  double K_vc_;                ///< [N/m]
  double F_s_;                 ///< [N]
  Vec3 shift_ = Vec3::Zero();  ///< s of the last contacts [m]
  Mat3 pass_ = Mat3::Zero();   ///< maps a motion of the tool to the part that reaches the contacts
};

/// The coupling force balances the contacts, at most n K d, and is below F_s.
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
          "along the sum g of the depths alone: f = -q K g, S = q S_sum, q = K_vc / (K_vc + K <u, S_sum u>), u = g "
          "/ |g|",
      .source = "thesis Fig. 2d",
      .known_failure =
          "limits the stiffness, but the force still follows the direction with the largest number of points",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<VirtualCoupling>,
          .force_bound = virtual_coupling_bound,
          .own_parameters = kAlongSum};
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
          "nearly opposite contacts push the tool out by up to 1 / (2 sqrt eps) times the norm of their depths",
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
          "tool balances -K sum p_i u_i = f; p_i = d_i + <u_i, s> where it has the sign of d_i, else 0; S = -df/dp "
          "/ K",
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
          .own_parameters = kSaturation};
}

}  // namespace hapbench
