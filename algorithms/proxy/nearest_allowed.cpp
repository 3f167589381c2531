#include "algorithms/proxy/nearest_allowed.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/proxy/small_qr.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

using simd::load, simd::Pack;

/// Squared sine of the angle between a gradient and the span of others below which it counts as lying in it: those on
/// one flat face of the tool, or along one line of its side, differ by rounding, 1e-15; other neighbours by far more
/// than this 3e-8.
constexpr double kInSpan = 1e-15;
constexpr int kMostIterations = 100;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Violation {
  std::size_t contact = 0;
  double amount = 0.0;  ///< d + <u, x> [m]
};

Violation largest_violation(const ContactBuffer& c, const Vec3& x) noexcept {
  const Pack x0(x.x()), x1(x.y()), x2(x.z());
  Pack largest(-kNever);
  const auto amount = [&](std::size_t i) {
    return load(&c.depth[i]) + (load(&c.ux[i]) * x0 + load(&c.uy[i]) * x1 + load(&c.uz[i]) * x2);
  };
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) largest = simd::max(largest, amount(i));
  const double most = simd::max_lane(largest);
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) {
    const simd::Mask here = amount(i) >= Pack(most);
    if (simd::any(here)) return {i + simd::first(here), most};
  }
  return {};
}

double largest_length(const ContactBuffer& c, const Vec3& wanted) noexcept {
  Pack largest(wanted.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) {
    largest = simd::max(largest, simd::abs(load(&c.depth[i])));
  }
  return simd::max_lane(largest);
}

/// The contacts that hold the tool back, at most three, with independent gradients.
class ActiveSet {
 public:
  int size() const { return static_cast<int>(size_); }
  std::size_t contact(int k) const { return contact_[static_cast<std::size_t>(k)]; }
  double& lambda(int k) { return lambda_[static_cast<std::size_t>(k)]; }

  bool contains(std::size_t contact) const {
    const auto end = contact_.begin() + static_cast<std::ptrdiff_t>(size_);
    return std::find(contact_.begin(), end, contact) != end;
  }
  void add(std::size_t contact, const Vec3& gradient, double lambda) {
    contact_[size_] = contact;
    lambda_[size_] = lambda;
    gradients_[size_++] = gradient;
  }
  void drop(int k) {
    --size_;
    for (auto j = static_cast<std::size_t>(k); j < size_; ++j) {
      contact_[j] = contact_[j + 1];
      lambda_[j] = lambda_[j + 1];
      gradients_[j] = gradients_[j + 1];
    }
  }
  /// u = sum of the active gradients times the first of these, plus a remainder perpendicular to all of them.
  Vec3 along(const Vec3& u) const { return SmallQr(gradients()).solve(u); }
  Vec3 combine(const Vec3& coefficients) const {
    if (size_ == 0) return Vec3::Zero();
    Vec3 sum = coefficients[0] * gradients_[0];
    for (std::size_t k = 1; k < size_; ++k) sum += coefficients[static_cast<Eigen::Index>(k)] * gradients_[k];
    return sum;
  }
  /// The orthogonal projector onto the span of the gradients.
  Mat3 projector() const { return SmallQr(gradients()).projector(); }

 private:
  std::span<const Vec3> gradients() const { return {gradients_.data(), size_}; }

  std::size_t size_ = 0;
  std::array<std::size_t, 3> contact_{};
  std::array<double, 3> lambda_{};
  std::array<Vec3, 3> gradients_{};
};

/// Makes contact `p` satisfied, letting go of active ones that no longer hold. False when that is impossible.
bool satisfy(std::size_t p, double violation, const Vec3& u, Vec3& x, ActiveSet& active) noexcept {
  double lambda = 0.0;
  for (;;) {
    const Vec3 r = active.along(u);
    const Vec3 free = u - active.combine(r);
    const double free2 = active.size() == 3 ? 0.0 : free.squaredNorm();
    const double whole_step = free2 > kInSpan ? violation / free2 : kNever;
    double step = whole_step;
    int leaves = -1;
    for (int k = 0; k < active.size(); ++k) {
      if (r[k] > 0.0 && active.lambda(k) / r[k] < step) {
        step = active.lambda(k) / r[k];
        leaves = k;
      }
    }
    if (step == kNever) return false;
    for (int k = 0; k < active.size(); ++k) active.lambda(k) -= step * r[k];
    lambda += step;
    if (whole_step != kNever) {
      x -= step * free;
      violation -= step * free2;
    }
    if (leaves < 0) {
      active.add(p, u, lambda);
      return true;
    }
    active.drop(leaves);
  }
}

/// The method of Goldfarb and Idnani; false, with the weights untouched, when the contacts contradict each other.
bool solve_exactly(const Vec3& wanted, double tolerance, ContactBuffer& contacts, AllowedMove& out) noexcept {
  ActiveSet active;
  out.move = wanted;
  for (;;) {
    const Violation worst = largest_violation(contacts, out.move);
    // An active contact is satisfied but for rounding.
    if (!(worst.amount > tolerance) || active.contains(worst.contact)) break;
    if (++out.iterations > kMostIterations) return false;
    if (!satisfy(worst.contact, worst.amount, contacts.gradient(worst.contact), out.move, active)) return false;
  }
  // A contact that is only just reached holds nothing; whether it counts would be left to rounding.
  for (int k = active.size() - 1; k >= 0; --k) {
    if (active.lambda(k) <= tolerance) active.drop(k);
  }
  for (int k = 0; k < active.size(); ++k) contacts.weight[active.contact(k)] = active.lambda(k);
  out.held = active.projector();
  return true;
}

/// The least-squares problem at one x: its value, gradient and Hessian.
struct Compromise {
  double value;
  Vec3 gradient;
  Mat3 hessian;

  Compromise(const ContactBuffer& c, const Vec3& wanted, const Vec3& x) noexcept {
    const Vec3 off = x - wanted;
    value = 0.5 * kCompromiseEpsilon * off.squaredNorm();
    gradient = kCompromiseEpsilon * off;
    hessian = kCompromiseEpsilon * Mat3::Identity();
    for (std::size_t i = 0; i < c.size(); ++i) {
      const Vec3 u = c.gradient(i);
      const double violation = c.depth[i] + u.dot(x);
      if (!(violation > 0.0)) continue;
      value += 0.5 * violation * violation;
      gradient += violation * u;
      hessian += u * u.transpose();
    }
  }
};

/// Newton with a line search: the problem is convex and piecewise quadratic, so it ends at the minimum.
void solve_least_squares(const Vec3& wanted, double tolerance, ContactBuffer& contacts, AllowedMove& out) noexcept {
  out.move = wanted;
  Compromise here(contacts, wanted, out.move);
  for (int i = 0; i < kMostIterations && here.gradient.norm() > kCompromiseEpsilon * tolerance; ++i, ++out.iterations) {
    const Vec3 direction = -Eigen::LLT<Mat3>(here.hessian).solve(here.gradient);
    double step = 1.0;
    Compromise next(contacts, wanted, out.move + direction);
    while (!(next.value <= here.value + 1e-4 * step * here.gradient.dot(direction)) && step > 1e-6) {
      step *= 0.5;
      next = Compromise(contacts, wanted, out.move + step * direction);
    }
    if (!(next.value < here.value)) break;  // rounding is all that is left
    out.move += step * direction;
    here = next;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts.weight[i] = std::max(0.0, contacts.depth[i] + contacts.gradient(i).dot(out.move));
  }
  const Eigen::LLT<Mat3> H(here.hessian);
  out.share = H.solve(wanted - out.move);
  out.held = Mat3::Identity() - kCompromiseEpsilon * Mat3(H.solve(Mat3::Identity()));
  out.held = 0.5 * (out.held + out.held.transpose()).eval();
}

}  // namespace

AllowedMove nearest_allowed(const Vec3& wanted, ContactBuffer& contacts) noexcept {
  set_weights(contacts, 0.0);
  AllowedMove out;
  const double tolerance = kViolationTolerance * largest_length(contacts, wanted);
  if (!solve_exactly(wanted, tolerance, contacts, out)) {
    out.feasible = false;
    solve_least_squares(wanted, tolerance, contacts, out);
  }
  return out;
}

}  // namespace hapbench
