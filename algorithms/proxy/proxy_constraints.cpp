#include "algorithms/proxy/proxy_constraints.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "algorithms/laws/force_law.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

using simd::load, simd::Pack;

/// Squared sine of the angle between a gradient and the span of other gradients below which the gradient counts
/// as part of the span. Gradients on one flat face of the tool, or along one line of its side, differ only by
/// rounding (1e-15). The threshold is an angle of 3e-8 rad. Other neighbouring gradients differ by far more.
constexpr double kInSpan = 1e-15;
constexpr int kMaxIterations = 100;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A violated constraint.
struct Violation {
  std::size_t contact = 0;
  double amount = 0.0;  ///< d + <u, x> [m]
};

/// Returns the largest violation, the first if several are equal. Returns amount 0 if all violations are within the
/// tolerance.
Violation largest_violation(const ContactBuffer& c, const Vec3& x, double tolerance) noexcept {
  const Pack x0(x.x()), x1(x.y()), x2(x.z());
  Pack largest(-kNever);
  const auto amount = [&](std::size_t i) {
    return load(&c.depth[i]) + (load(&c.ux[i]) * x0 + load(&c.uy[i]) * x1 + load(&c.uz[i]) * x2);
  };
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) largest = simd::max(largest, amount(i));
  const double largest_amount = simd::max_lane(largest);
  if (!(largest_amount > tolerance)) return {};
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) {
    const std::uint8_t here = simd::bits(amount(i) >= Pack(largest_amount));
    if (here != 0) return {i + static_cast<std::size_t>(std::countr_zero(here)), largest_amount};
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

/// A gradient split into its projection on the span of the active gradients and the remainder.
struct Split {
  Vec3 inside = Vec3::Zero();  ///< components of the projection in the orthonormal basis of the span
  Vec3 remainder;              ///< perpendicular to all active gradients
  Vec3 along = Vec3::Zero();   ///< coefficients of the projection as a combination of the active gradients
};

/// The active set: at most three contacts that hold the tool back, with linearly independent gradients. Keeps
/// the factorisation gradients = Q R by Gram and Schmidt, which takes a few operations for three columns.
class ActiveSet {
 public:
  int size() const { return size_; }
  std::size_t contact(int k) const { return contact_[static_cast<std::size_t>(k)]; }
  double& lambda(int k) { return lambda_[static_cast<std::size_t>(k)]; }

  bool contains(std::size_t contact) const {
    return std::find(contact_.begin(), contact_.begin() + size_, contact) != contact_.begin() + size_;
  }
  Split split(const Vec3& u) const {
    Split parts{.remainder = u};
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
  /// Adds a contact. `parts` is the split of its gradient; its remainder must not be zero.
  void add(std::size_t contact, const Vec3& gradient, const Split& parts, double lambda) {
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
      const Vec3& u = before.gradients_[k];
      add(before.contact_[k], u, split(u), before.lambda_[k]);
    }
  }
  /// Returns the orthogonal projector onto the span of the gradients.
  Mat3 projector() const {
    Mat3 P = Mat3::Zero();
    for (int k = 0; k < size_; ++k) P += Q_.col(k) * Q_.col(k).transpose();
    return P;
  }

 private:
  int size_ = 0;
  std::array<std::size_t, 3> contact_{};
  std::array<double, 3> lambda_{};
  std::array<Vec3, 3> gradients_;
  Mat3 Q_, R_;  ///< the first size() columns are valid
};

/// Makes contact `p` satisfied and active, and removes active contacts that no longer hold the tool back.
/// Returns false if this is impossible.
bool satisfy(std::size_t p, double violation, const Vec3& u, Vec3& x, ActiveSet& active) noexcept {
  double lambda = 0.0;
  for (;;) {
    const Split parts = active.split(u);
    const Vec3 &r = parts.along, &free = parts.remainder;
    const double free2 = active.size() == 3 ? 0.0 : free.squaredNorm();
    const double whole_step = free2 > kInSpan ? violation / free2 : kNever;
    // Shorten the step where a multiplier would become negative; this contact leaves the active set.
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

/// The method of Goldfarb and Idnani. Returns false and leaves the weights unchanged if the contacts contradict
/// each other.
bool solve_exactly(const Vec3& wanted, double tolerance, ContactBuffer& contacts, AllowedMove& out) noexcept {
  ActiveSet active;
  out.move = wanted;
  for (;;) {
    const Violation worst = largest_violation(contacts, out.move, tolerance);
    // An active contact is violated by rounding only.
    if (!(worst.amount > tolerance) || active.contains(worst.contact)) break;
    if (++out.iterations > kMaxIterations) return false;
    if (!satisfy(worst.contact, worst.amount, contacts.gradient(worst.contact), out.move, active)) return false;
  }
  // A contact that the move only just reaches does not hold the tool back. Make it inactive, because otherwise
  // rounding would decide whether it is active.
  for (int k = active.size() - 1; k >= 0; --k) {
    if (active.lambda(k) <= tolerance) active.remove(k);
  }
  for (int k = 0; k < active.size(); ++k) contacts.weight[active.contact(k)] = active.lambda(k);
  out.held = active.projector();
  return true;
}

/// The least-squares problem at one move x: value, gradient and Hessian.
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

/// Newton's method with a line search. It ends at the minimum, because the problem is convex and piecewise
/// quadratic.
void solve_least_squares(const Vec3& wanted, double tolerance, ContactBuffer& contacts, AllowedMove& out) noexcept {
  out.move = wanted;
  Compromise here(contacts, wanted, out.move);
  for (int i = 0; i < kMaxIterations && here.gradient.norm() > kCompromiseEpsilon * tolerance; ++i, ++out.iterations) {
    const Vec3 direction = -Eigen::LLT<Mat3>(here.hessian).solve(here.gradient);
    double step = 1.0;
    Compromise next(contacts, wanted, out.move + direction);
    while (!(next.value <= here.value + 1e-4 * step * here.gradient.dot(direction)) && step > 1e-6) {
      step *= 0.5;
      next = Compromise(contacts, wanted, out.move + step * direction);
    }
    if (!(next.value < here.value)) break;  // only rounding is left
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

/// Factor on the margin of the search. The margin must exceed the largest move of the proxy by the rounding errors of
/// margin and move.
constexpr double kQueryMargin = 1.0 + 1e-6;
/// Distance, relative to the spacing, by which a point may lie inside one of the two faces at an edge and still count
/// as beyond the edge.
constexpr double kEdgeSlack = 1e-3;

/// Number of points whose spacing is measured.
constexpr std::size_t kSpacingSamples = 100;
/// Radius of a patch relative to the spacing. In a square lattice of points, the patches cover the centre between
/// four points, which is 0.707 spacings away from each.
constexpr double kPatch = 0.75;
/// Largest depth at which an edge constraint applies, relative to the spacing.
constexpr double kMaxPatchDepth = 0.1;

/// Points closer than this fraction of the shell's size count as one point, because shells may list a vertex
/// once for each of its cells.
constexpr double kSamePosition = 1e-7;

/// Returns the distance [m] from a point to the second nearest of the other points. Points at the same position count
/// as one point.
double distance_to_second(const PointShell& shell, std::size_t from) {
  const double same = kSamePosition * shell.bounds().size().norm(), same2 = same * same;
  double first2 = kNever, second2 = kNever;
  const Vec3 here = shell.point(from).position;
  Vec3 nearest = here;
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const Vec3 position(shell.x()[i], shell.y()[i], shell.z()[i]);
    const double distance2 = (position - here).squaredNorm();
    if (distance2 >= second2 || distance2 <= same2 || (position - nearest).squaredNorm() <= same2) continue;
    if (distance2 < first2) {
      second2 = first2;
      first2 = distance2;
      nearest = position;
    } else {
      second2 = distance2;
    }
  }
  return std::sqrt(second2);
}

/// Returns the typical distance from a shell point to its neighbours [m]; 0 for fewer than three points. It is the
/// median, over a sample of points, of the distance to the second nearest position, which is the spacing of a square
/// lattice and of a line. Points at the same position count as one point. O(size), about a hundred distances for each
/// point.
double typical_spacing(const PointShell& shell) {
  if (shell.size() < 3) return 0.0;
  const std::size_t samples = std::min(kSpacingSamples, shell.size());
  std::vector<double> distances;
  for (std::size_t k = 0; k < samples; ++k) distances.push_back(distance_to_second(shell, k * shell.size() / samples));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(samples / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
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

ShellConstraints::ShellConstraints(const PointShell& shell, const ToolShape& tool, Skips skips)
    : tool_(&tool),
      margin_(kProxyMargin * tool.half_width()),
      spacing_(typical_spacing(shell)),
      reach_(tool.grown(margin_ * kQueryMargin)),
      near_(make_contact_query(shell, *reach_.shape, skips)),
      support_x_(simd::padded(near_->capacity())),
      support_y_(support_x_.size()),
      support_z_(support_x_.size()) {}

/// Keeps the edges of the tool from sinking in between the points of a shell. The edge of a drill on a wall
/// could sink by up to 0.05 mm between two lines of points 0.1 mm apart, because it touches points with both of
/// its faces.
///
/// The surface around each point x_i with normal n_i is assumed to be flat up to the neighbouring points. Let v_i be
/// the tool's support point towards the surface, argmin <q, n_i> over the tool. If v_i lies on this patch, the tool
/// must stay above the patch:
///
///   <n_i, v_i + x - x_i> >= 0, appended as a contact with depth <n_i, x_i - v_i> and gradient -n_i.
///
/// Patches apply at distances up to the margin and depths up to a tenth of the spacing. A patch outside this
/// range belongs to another part of the surface, such as the other side of a rim. Called after
/// ToolShape::surface_constraints. Precondition: room for twice the contacts. O(n).
void ShellConstraints::add_edges(const ToolPose& proxy, ContactBuffer& contacts) noexcept {
  const std::size_t points = contacts.size(), padded = contacts.padded_size();
  const PackRange all{0, padded / simd::lanes, 0xff, static_cast<std::uint8_t>(0xffu >> (padded - points))};
  const PointColumns columns{contacts.index.data(), contacts.x.data(),  contacts.y.data(), contacts.z.data(),
                             contacts.nx.data(),    contacts.ny.data(), contacts.nz.data()};
  const Pack highest(margin_), deepest(-kMaxPatchDepth * spacing_), patch2(kPatch * spacing_ * kPatch * spacing_);
  const MutablePointArrays support{support_x_.data(), support_y_.data(), support_z_.data()};
  tool_->support_points(proxy, contacts, support);
  // For each contact whose support point lies on its patch, append the constraint of the patch.
  for (std::size_t i = 0; i < padded; i += simd::lanes) {
    const Pack nx = load(&contacts.nx[i]), ny = load(&contacts.ny[i]), nz = load(&contacts.nz[i]);
    const Pack dx = load(&support.x[i]) - load(&contacts.x[i]), dy = load(&support.y[i]) - load(&contacts.y[i]),
               dz = load(&support.z[i]) - load(&contacts.z[i]);
    const Pack height = nx * dx + ny * dy + nz * dz;
    const Pack aside2 = dx * dx + dy * dy + dz * dz - height * height;
    const simd::Mask applies = height <= highest && height >= deepest && aside2 <= patch2;
    const std::uint8_t patches = all.own(simd::bits(applies), i / simd::lanes);
    if (patches == 0) continue;
    const std::size_t to = contacts.size();
    contacts.extend(simd::copy_selected(patches, columns, i, contacts, to));
    const auto write = [patches, to](const Pack& values, AlignedDoubles& column) {
      alignas(64) double eight[simd::lanes];
      simd::store(values, eight);
      simd::store_selected(patches, eight, &column[to]);
    };
    write(-height, contacts.depth);
    write(-nx, contacts.ux);
    write(-ny, contacts.uy);
    write(-nz, contacts.uz);
  }
  contacts.pad();
}

void ShellConstraints::constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept {
  near_->contacts_at({proxy.position + reach_.forward * proxy.axis, proxy.axis, proxy.roll}, contacts);
  tool_->surface_constraints(proxy, wanted, kEdgeSlack * spacing_, contacts);
  add_edges(proxy, contacts);
}

void SpringConstraints::constraints_at(const ToolPose& proxy, const Vec3&, ContactBuffer& contacts) noexcept {
  contacts.clear();
  for (std::size_t j = 0; j < springs_->gradients.size(); ++j) {
    const Vec3& u = springs_->gradients[j];
    const double depth = proxy.position.dot(u);
    // If the depth is NaN, both conditions are false, so the spring is not compressed.
    if (depth > -kNever) push_spring(j, proxy.position, depth, u, contacts);
    if (springs_->bilateral && -depth > -kNever) push_spring(j, proxy.position, -depth, -u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

}  // namespace hapbench
