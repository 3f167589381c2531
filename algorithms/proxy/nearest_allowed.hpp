#pragma once

#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

/// Violation, relative to the largest length of the problem, up to which a contact counts as satisfied: above the
/// rounding of the solution and of gradients, far below anything felt (1e-11 m in a search of 0.1 mm).
inline constexpr double kViolationTolerance = 1e-7;
/// epsilon of the compromise between contacts that contradict each other.
inline constexpr double kCompromiseEpsilon = 1e-6;

/// The move nearest to a wanted one that a set of contacts allows.
struct AllowedMove {
  Vec3 move = Vec3::Zero();   ///< x [m]
  Mat3 held = Mat3::Zero();   ///< I - dx/dt: the projector onto the span of the contacts that hold the tool back
  bool feasible = true;       ///< false: no move satisfies all contacts, x is the least-squares compromise
  Vec3 share = Vec3::Zero();  ///< if infeasible: <u_i, share> is the part of contact i in the residual t - x [m]
  int iterations = 0;
};

/// Solves, in three unknowns,
///
///     minimise |x - t|^2   subject to   d_i + <u_i, x> <= 0   for all contacts
///
/// with the dual active-set method of Goldfarb and Idnani (Mathematical Programming 27, 1983), which for the identity
/// as Hessian needs no more than three active contacts and small orthogonal factors. Each iteration takes the contact
/// that is violated most (the first of equals), so the answer is deterministic. Leaves the multipliers lambda_i >= 0
/// [m] as weights in the buffer: x = t - sum lambda_i u_i, lambda_i = 0 for contacts that do not hold.
///
/// Contacts count as satisfied within kViolationTolerance of the problem's largest length. If no x satisfies all of
/// them (opposite walls of a slot narrower than the tool), x is instead the unique minimiser of
///
///     1/2 sum max(0, d_i + <u_i, x>)^2 + epsilon/2 |x - t|^2,   epsilon = 1e-6,
///
/// where opposite walls are shared in equal squares. The weights are then the violations w_i = max(0, d_i + <u_i, x>),
/// and lambda_i = w_i + <u_i, share>, which may be negative, has the same identity but for epsilon: opposite violations
/// cancel, share = H^-1 (t - x) divides the rest, H = sum u u^T + epsilon I over the violated. These lambda_i are the
/// derivatives by d_i of 1/2 |x - t|^2 + 1/2 sum w^2, so forces and moments computed from them create no energy.
/// O(n) per iteration, typically one to five iterations. Precondition: contacts are padded, gradients are unit vectors;
/// otherwise finite. Allocates nothing.
AllowedMove nearest_allowed(const Vec3& wanted, ContactBuffer& contacts) noexcept;

}  // namespace hapbench
