#include "algorithms/laws/exact_shaping.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/simd.hpp"

namespace hapbench {

const ModelInfo kExactShapingInfo = {
    .name = "exact_shaping",
    .summary = "what the shaping iteration converges to, computed exactly",
    .formula = "c = argmin ½|S - I|²_F + (epsilon/2)|c|² over c >= 0, epsilon = 1e-6: the projection of the identity onto "
               "the cone of contact tensors u u^T",
    .source = "ours; the iteration is the multiplicative update of Sha, Lin, Saul, Lee, Neural Computation 2007",
    .known_failure = "as shaped_stiffness: ratios above 1 where the weight is zero, soft along the way out of a wedge",
};

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr double kEps = kExactShapingEpsilon;
constexpr int kMaxNewtonSteps = 100;
constexpr int kMaxLineSearchSteps = 40;
constexpr int kRefinements = 2;

/// The identity in the basis below.
const Vec6& identity6() {
  static const Vec6 identity = (Vec6() << 1, 1, 1, 0, 0, 0).finished();
  return identity;
}

/// u u^T for eight contacts in the orthonormal basis (xx, yy, zz, sqrt2 xy, sqrt2 xz, sqrt2 yz), in which the Frobenius
/// product of two symmetric matrices is a dot product: the six-vectors a_i of the solver.
struct TensorPack {
  simd::Pack a[6];

  TensorPack(const ContactBuffer& c, std::size_t i) {
    const simd::Pack x = simd::load(&c.ux[i]), y = simd::load(&c.uy[i]), z = simd::load(&c.uz[i]);
    const simd::Pack root2(std::numbers::sqrt2);
    a[0] = x * x;
    a[1] = y * y;
    a[2] = z * z;
    a[3] = root2 * x * y;
    a[4] = root2 * x * z;
    a[5] = root2 * y * z;
  }
  simd::Pack dot(const Vec6& w) const {
    return ((a[0] * simd::Pack(w[0]) + a[1] * simd::Pack(w[1])) + (a[2] * simd::Pack(w[2]) + a[3] * simd::Pack(w[3]))) +
           (a[4] * simd::Pack(w[4]) + a[5] * simd::Pack(w[5]));
  }
};

/// One pass over the contacts at the point w of the dual: c_i = max(0, a_i . w).
struct Pass {
  Mat6 G;           ///< sum a a^T over the active contacts, c_i > 0
  Vec6 S;           ///< sum c_i a_i
  bool same_active; ///< no contact changed between active and inactive
};

Pass evaluate(ContactBuffer& contacts, const Vec6& w) noexcept {
  using simd::Pack;
  Pack g[21], s[6];
  std::fill(std::begin(g), std::end(g), Pack(0.0));
  std::fill(std::begin(s), std::end(s), Pack(0.0));
  const Pack zero(0.0), one(1.0);
  bool same = true;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const TensorPack u(contacts, i);
    const Pack t = u.dot(w);
    const simd::Mask active = t > zero;
    const simd::Mask before = simd::load(&contacts.weight[i]) > zero;
    same = same && !simd::any((active && !before) || (before && !active));
    const Pack c = simd::select(active, t, zero), on = simd::select(active, one, zero);
    simd::store(c, &contacts.weight[i]);
    for (int j = 0, k = 0; j < 6; ++j) {
      s[j] += c * u.a[j];
      const Pack masked = on * u.a[j];
      for (int l = 0; l <= j; ++l) g[k++] += masked * u.a[l];
    }
  }
  Pass pass;
  pass.same_active = same;
  for (int j = 0, k = 0; j < 6; ++j) {
    pass.S[j] = simd::sum(s[j]);
    for (int l = 0; l <= j; ++l) pass.G(j, l) = pass.G(l, j) = simd::sum(g[k++]);
  }
  return pass;
}

Eigen::LDLT<Mat6> regularised(const Mat6& G) {
  return Eigen::LDLT<Mat6>(G + kEps * Mat6::Identity());
}

/// Gradient of the convex dual ½|eps w - I|² / eps + ½ sum max(0, a_i . w)²: zero at the optimum.
Vec6 dual_gradient(const Vec6& w, const Pass& pass) {
  return kEps * w - identity6() + pass.S;
}

/// Moves from w towards `target` until the dual's slope along the way is no longer steep (bisection on a monotone
/// slope). The dual is convex and piecewise quadratic, so this descends and Newton's method converges from anywhere.
/// `pass` comes in evaluated at `target` and goes out evaluated at the returned point.
Vec6 line_search(ContactBuffer& contacts, const Vec6& w, const Vec6& target, double slope_at_w, Pass& pass) noexcept {
  const Vec6 way = target - w;
  Vec6 trial = target;
  double low = 0.0, high = 1.0, fraction = 1.0;
  for (int i = 0; i < kMaxLineSearchSteps; ++i) {
    const double slope = dual_gradient(trial, pass).dot(way);
    const bool still_descending_at_target = fraction == 1.0 && slope <= 0.0;
    if (still_descending_at_target || std::abs(slope) <= 0.5 * std::abs(slope_at_w)) break;
    (slope > 0.0 ? high : low) = fraction;
    fraction = 0.5 * (low + high);
    trial = w + fraction * way;
    pass = evaluate(contacts, trial);
  }
  return trial;
}

/// Removes the rounding of the last solve, which the factor 1/eps has amplified: with R the residual of the optimality
/// condition, c_i += a_i . (eps I + G)^-1 R on the active contacts.
void refine(ContactBuffer& contacts, const Eigen::LDLT<Mat6>& system, Vec6 w, Vec6 S) noexcept {
  using simd::Pack;
  const Pack zero(0.0);
  for (int round = 0; round < kRefinements; ++round) {
    const Vec6 correction = system.solve(identity6() - kEps * w - S);
    w += correction;
    Pack s[6];
    std::fill(std::begin(s), std::end(s), zero);
    for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
      const TensorPack u(contacts, i);
      const Pack c = simd::load(&contacts.weight[i]);
      const Pack refined = simd::select(c > zero, simd::max(zero, c + u.dot(correction)), zero);
      simd::store(refined, &contacts.weight[i]);
      for (int j = 0; j < 6; ++j) s[j] += refined * u.a[j];
    }
    for (int j = 0; j < 6; ++j) S[j] = simd::sum(s[j]);
  }
}

}  // namespace

int solve_exact_shaping(ContactBuffer& contacts) noexcept {
  set_weights(contacts, 1.0);
  // A contact whose exact weight is zero may flicker between active and inactive by rounding, 1e-16 / eps a contact.
  const double rounding = 1e-15 / kEps * (1.0 + static_cast<double>(contacts.size()));
  // Every contact is active at w = identity, because a_i . identity = |u_i|² = 1.
  Vec6 w = identity6();
  Pass pass = evaluate(contacts, w);
  for (int step = 1; step <= kMaxNewtonSteps; ++step) {
    // On a fixed active set the dual is quadratic; its minimum is where (eps I + G) w = identity.
    const Vec6 target = regularised(pass.G).solve(identity6());
    const double slope = dual_gradient(w, pass).dot(target - w);
    pass = evaluate(contacts, target);
    if (pass.same_active || dual_gradient(target, pass).norm() <= rounding) {
      refine(contacts, regularised(pass.G), target, pass.S);
      return step;
    }
    w = line_search(contacts, w, target, slope, pass);
  }
  return kMaxNewtonSteps;
}

namespace {

class ExactShaping final : public ForceLaw {
 public:
  explicit ExactShaping(double stiffness) : K_(stiffness) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    iterations_ += static_cast<std::uint64_t>(solve_exact_shaping(contacts));
    return weighted_force(contacts, K_);
  }

 private:
  double K_;
};

}  // namespace

std::unique_ptr<ForceLaw> make_exact_shaping(const RenderingConfig& config) {
  return std::make_unique<ExactShaping>(config.stiffness);
}

}  // namespace hapbench
