#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "algorithms/parameters.hpp"
#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr OwnParameter kSaturation[] = {{"saturation_N",
                                         {1e-6, 1e12, "N"},
                                         30.0,
                                         "F_s: the coupling never pulls with more; default what the trainer gives"}};

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

AlgorithmEntry static_coupling_entry() {
  static constexpr ParameterInfo kParameters[] = {
      kStiffnessParameter,
      {parameter::kVirtualCoupling, "K_vc: stiffness of the coupling spring before it saturates; null: K"},
  };
  static constexpr ModelInfo kInfo = {
      .name = "static_coupling",
      .summary = "a massless copy of the tool in balance between its contacts and a coupling spring that saturates",
      .formula =
          "f = g(|s|) s / |s|, g(x) = K_vc x / sqrt(1 + (K_vc x / F_s)^2), where the copy's displacement s from the tool "
          "balances -K sum p_i u_i = f; p_i = d_i + <u_i, s> where it has the sign of d_i, else 0; S = -df/dp / K",
      .source =
          "static virtual coupling of Barbic and James, Six-DoF haptic rendering of contact between geometrically complex "
          "reduced deformable models (IEEE Trans. Haptics 1, 2008); the shape of g and solving it to the end are ours",
      .known_failure =
          "the copy follows the direction with most points, and what lies beyond the saturation feels soft",
      .parameters = kParameters,
  };
  return {.info = &kInfo,
          .make_law = law_of<StaticCoupling>,
          .theory = {.force_bound = static_coupling_bound},
          .may_reduce = false,
          .own_parameters = kSaturation};
}

}  // namespace hapbench
