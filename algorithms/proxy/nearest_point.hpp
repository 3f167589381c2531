#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "sim/core/types.hpp"

/// Finds the point x of a polyhedron in N dimensions that is nearest to a given point t. A proxy solves this quadratic
/// program in every pass, with N = 3 if the proxy only translates, and N = 6 if it also rotates.
///
///   minimise |x - t|^2   subject to   d_i + <u_i, x> <= 0
///
/// A type `Rows` of constraints has the functions
///   size()                            number of constraints
///   depth(i), row(i)                  d_i and the vector u_i of dimension N
///   largest_violation(x, tolerance)   the constraint with the largest d_i + <u_i, x>, the first if several are equal;
///                                     a Violation of amount 0 if no d_i + <u_i, x> exceeds the tolerance
/// The functions of this file allocate nothing.
namespace hapbench::nearest_point {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

/// Threshold for the squared sine of the angle between a gradient and the span of other gradients. Below it, the
/// gradient counts as part of the span. Gradients on one flat face of the tool, or along one straight line of its
/// curved side, differ only by rounding (1e-15). The threshold is an angle of 3e-8 rad. Other neighbouring gradients
/// differ by far more.
inline constexpr double kInSpan = 1e-15;
inline constexpr int kMaxIterations = 100;
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// A violated constraint.
struct Violation {
  std::size_t contact = 0;
  double amount = 0.0;  ///< d + <u, x>
};

/// Result of splitting a gradient into its projection on the span of the active gradients and the remainder.
template <int N>
struct Split {
  Vector<N> inside = Vector<N>::Zero();  ///< components of the projection in the orthonormal basis of the span
  Vector<N> remainder;                   ///< perpendicular to all active gradients
  Vector<N> along = Vector<N>::Zero();   ///< coefficients of the projection as a combination of the active gradients
};

/// The active set: at most N constraints with linearly independent gradients and multipliers lambda >= 0, which hold
/// the point x back from t. Keeps the factorisation Q R of the matrix of the gradients, computed by Gram and Schmidt's
/// method, which is fast for so few columns.
template <int N>
class ActiveSet {
 public:
  int size() const { return size_; }
  std::size_t contact(int k) const { return contact_[static_cast<std::size_t>(k)]; }
  double& lambda(int k) { return lambda_[static_cast<std::size_t>(k)]; }
  double lambda(int k) const { return lambda_[static_cast<std::size_t>(k)]; }

  bool contains(std::size_t contact) const {
    return std::find(contact_.begin(), contact_.begin() + size_, contact) != contact_.begin() + size_;
  }
  Split<N> split(const Vector<N>& u) const {
    Split<N> parts{.remainder = u};
    // The second round removes the rounding errors of the first round, which matter if the remainder is short.
    for (int round = 0; round < 2; ++round) {
      for (int k = 0; k < size_; ++k) {
        const double part = Q_.col(k).dot(parts.remainder);
        parts.inside[k] += part;
        parts.remainder -= part * Q_.col(k);
      }
    }
    for (int k = size_; k-- > 0;) {
      double rest = parts.inside[k];
      for (int j = k + 1; j < size_; ++j) rest -= R_(k, j) * parts.along[j];
      parts.along[k] = rest / R_(k, k);
    }
    return parts;
  }
  /// Adds a constraint. `parts` is the split of its gradient; its remainder must not be zero.
  void add(std::size_t contact, const Vector<N>& gradient, const Split<N>& parts, double lambda) {
    const auto k = static_cast<std::size_t>(size_);
    contact_[k] = contact;
    lambda_[k] = lambda;
    gradients_[k] = gradient;
    const double length = parts.remainder.norm();
    R_.col(size_) = parts.inside;
    R_(size_, size_) = length;
    Q_.col(size_++) = parts.remainder / length;
  }
  void remove(int leaving) {
    const ActiveSet before = *this;
    size_ = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(before.size_); ++k) {
      if (static_cast<int>(k) == leaving) continue;
      const Vector<N>& u = before.gradients_[k];
      add(before.contact_[k], u, split(u), before.lambda_[k]);
    }
  }
  /// Returns the orthogonal projector onto the span of the gradients.
  Matrix<N> projector() const {
    Matrix<N> P = Matrix<N>::Zero();
    for (int k = 0; k < size_; ++k) P += Q_.col(k) * Q_.col(k).transpose();
    return P;
  }

 private:
  int size_ = 0;
  std::array<std::size_t, std::size_t{N}> contact_{};
  std::array<double, std::size_t{N}> lambda_{};
  std::array<Vector<N>, std::size_t{N}> gradients_;
  Matrix<N> Q_, R_;  ///< the first size() columns are valid
};

/// Moves x so that constraint `p` with the gradient u is satisfied, and makes it active. `violation` is d_p + <u, x> >
/// 0 at entry. Removes active constraints that no longer hold the point back. Returns false if constraint `p`
/// contradicts the active constraints.
template <int N>
bool satisfy(std::size_t p, double violation, const Vector<N>& u, Vector<N>& x, ActiveSet<N>& active) noexcept {
  double lambda = 0.0;
  for (;;) {
    const Split<N> parts = active.split(u);
    const Vector<N>&r = parts.along, &free = parts.remainder;
    const double free2 = active.size() == N ? 0.0 : free.squaredNorm();
    const double whole_step = free2 > kInSpan ? violation / free2 : kNever;
    // If the multiplier of an active constraint would become negative, end the step where this multiplier is zero. This
    // constraint then leaves the active set.
    double step = whole_step;
    int leaving = -1;
    for (int k = 0; k < active.size(); ++k) {
      if (r[k] > 0.0 && active.lambda(k) / r[k] < step) {
        step = active.lambda(k) / r[k];
        leaving = k;
      }
    }
    if (step == kNever) return false;
    for (int k = 0; k < active.size(); ++k) active.lambda(k) -= step * r[k];
    lambda += step;
    if (whole_step != kNever) {
      x -= step * free;
      violation -= step * free2;
    }
    if (leaving < 0) {
      active.add(p, u, parts, lambda);
      return true;
    }
    active.remove(leaving);
  }
}

/// The dual active-set method of Goldfarb and Idnani. On entry, `x` is t and `active` is empty. Returns false if the
/// constraints contradict each other. Adds the number of constraints that were made active to `iterations`.
template <int N, class Rows>
bool solve_exactly(const Rows& rows, double tolerance, Vector<N>& x, ActiveSet<N>& active, int& iterations) noexcept {
  for (;;) {
    const Violation worst = rows.largest_violation(x, tolerance);
    // An active constraint can only be violated by rounding.
    if (!(worst.amount > tolerance) || active.contains(worst.contact)) break;
    if (++iterations > kMaxIterations) return false;
    if (!satisfy<N>(worst.contact, worst.amount, rows.row(worst.contact), x, active)) return false;
  }
  // A constraint that the point only just touches does not hold the point back. Make it inactive, because otherwise
  // rounding would decide whether it is active.
  for (int k = active.size() - 1; k >= 0; --k) {
    if (active.lambda(k) <= tolerance) active.remove(k);
  }
  return true;
}

/// Value, gradient and Hessian, with respect to x, of the function
///
///   1/2 sum max(0, d_i + <u_i, x>)^2 + epsilon/2 |x - t|^2
///
/// at one point x. The minimum of the function is the least-squares compromise between contradictory constraints.
/// `wanted` is t.
template <int N>
struct Compromise {
  double value;
  Vector<N> gradient;
  Matrix<N> hessian;

  template <class Rows>
  Compromise(const Rows& rows, const Vector<N>& wanted, const Vector<N>& x, double epsilon) noexcept {
    const Vector<N> off = x - wanted;
    value = 0.5 * epsilon * off.squaredNorm();
    gradient = epsilon * off;
    hessian = epsilon * Matrix<N>::Identity();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Vector<N> u = rows.row(i);
      const double violation = rows.depth(i) + u.dot(x);
      if (!(violation > 0.0)) continue;
      value += 0.5 * violation * violation;
      gradient += violation * u;
      hessian += u * u.transpose();
    }
  }
};

/// Minimises the function of Compromise by Newton's method with a line search. The method converges, because the
/// function is convex and piecewise quadratic. On entry, `x` is t; on return, `x` is the minimum. Returns value,
/// gradient and Hessian at the minimum. Adds the number of Newton steps to `iterations`.
template <int N, class Rows>
Compromise<N> solve_least_squares(const Rows& rows, double epsilon, double tolerance, Vector<N>& x,
                                  int& iterations) noexcept {
  const Vector<N> wanted = x;
  Compromise<N> here(rows, wanted, x, epsilon);
  for (int i = 0; i < kMaxIterations && here.gradient.norm() > epsilon * tolerance; ++i, ++iterations) {
    const Vector<N> direction = -Eigen::LLT<Matrix<N>>(here.hessian).solve(here.gradient);
    double step = 1.0;
    Compromise<N> next(rows, wanted, x + direction, epsilon);
    while (!(next.value <= here.value + 1e-4 * step * here.gradient.dot(direction)) && step > 1e-6) {
      step *= 0.5;
      next = Compromise<N>(rows, wanted, x + step * direction, epsilon);
    }
    if (!(next.value < here.value)) break;  // only rounding errors remain
    x += step * direction;
    here = next;
  }
  return here;
}

}  // namespace hapbench::nearest_point
