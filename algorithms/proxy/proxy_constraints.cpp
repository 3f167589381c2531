#include "algorithms/proxy/proxy_constraints.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/proxy/nearest_point.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

using nearest_point::kNever, nearest_point::Violation;
using simd::load, simd::Pack;

/// Presents the contacts as constraints (`Rows` of nearest_point.hpp) on a translation x.
class MoveRows {
 public:
  explicit MoveRows(const ContactBuffer& contacts) : c_(contacts) {}

  std::size_t size() const { return c_.size(); }
  double depth(std::size_t i) const { return c_.depth[i]; }
  Vec3 row(std::size_t i) const { return c_.gradient(i); }
  Violation largest_violation(const Vec3& x, double tolerance) const noexcept {
    const Pack x0(x.x()), x1(x.y()), x2(x.z());
    Pack largest(-kNever);
    const auto amount = [&](std::size_t i) {
      return load(&c_.depth[i]) + (load(&c_.ux[i]) * x0 + load(&c_.uy[i]) * x1 + load(&c_.uz[i]) * x2);
    };
    for (std::size_t i = 0; i < c_.padded_size(); i += simd::lanes) largest = simd::max(largest, amount(i));
    const double largest_amount = simd::max_lane(largest);
    if (!(largest_amount > tolerance)) return {};
    for (std::size_t i = 0; i < c_.padded_size(); i += simd::lanes) {
      const std::uint8_t here = simd::bits(amount(i) >= Pack(largest_amount));
      if (here != 0) return {i + static_cast<std::size_t>(std::countr_zero(here)), largest_amount};
    }
    return {};
  }

 private:
  const ContactBuffer& c_;
};

double largest_length(const ContactBuffer& c, const Vec3& wanted) noexcept {
  Pack largest(wanted.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < c.padded_size(); i += simd::lanes) {
    largest = simd::max(largest, simd::abs(load(&c.depth[i])));
  }
  return simd::max_lane(largest);
}

/// Factor on the margin of the contact search. The margin of the search must exceed the largest move of the proxy by
/// the rounding errors of margin and move.
constexpr double kQueryMargin = 1.0 + 1e-6;
/// At an edge of the tool, a point counts as beyond both faces if it lies beyond one face and inside the other face by
/// at most this distance, relative to the spacing of the shell points.
constexpr double kEdgeSlack = 1e-3;

/// Largest number of shell points at which typical_spacing() measures the distance to the neighbours.
constexpr std::size_t kSpacingSamples = 100;
/// Radius of a patch (see add_edges), relative to the typical spacing of the shell points. In a square lattice of
/// points, the patches cover the centre between four points, which is 0.707 spacings away from each of these points.
constexpr double kPatch = 0.75;
/// Largest depth of the tool below a patch at which the constraint of the patch applies (see add_edges), relative to
/// the typical spacing of the shell points.
constexpr double kMaxPatchDepth = 0.1;

/// Points closer than this fraction of the diagonal of the shell's bounding box count as one point, because a shell may
/// list a vertex once for each grid cell that has the vertex on an edge.
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

/// Returns the typical distance from a shell point to its neighbours [m]; 0 for fewer than three points. For each point
/// of a sample, computes the distance to the second nearest position. In a square lattice and in a row of points, this
/// distance is the spacing. Returns the median of these distances. Points at the same position count as one point.
/// O(size), with kSpacingSamples distances for each shell point.
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
  const MoveRows rows(contacts);
  const double tolerance = kViolationTolerance * largest_length(contacts, wanted);
  out.move = wanted;
  nearest_point::ActiveSet<3> active;
  if (nearest_point::solve_exactly<3>(rows, tolerance, out.move, active, out.iterations)) {
    for (int k = 0; k < active.size(); ++k) contacts.weight[active.contact(k)] = active.lambda(k);
    out.held = active.projector();
    return out;
  }
  out.feasible = false;
  out.move = wanted;
  const Eigen::LLT<Mat3> H(
      nearest_point::solve_least_squares<3>(rows, kCompromiseEpsilon, tolerance, out.move, out.iterations).hessian);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts.weight[i] = std::max(0.0, contacts.depth[i] + contacts.gradient(i).dot(out.move));
  }
  out.share = H.solve(wanted - out.move);
  out.held = Mat3::Identity() - kCompromiseEpsilon * Mat3(H.solve(Mat3::Identity()));
  out.held = 0.5 * (out.held + out.held.transpose()).eval();
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
/// The surface around each point x_i with normal n_i is assumed to be flat up to the neighbouring points. This flat
/// piece is called a patch. Let v_i be the tool's support point towards the surface: the point q of the tool with the
/// smallest <q, n_i>. If the projection of v_i along n_i lies on the patch, the tool must be above the patch after the
/// move x:
///
///   <n_i, v_i + x - x_i> >= 0, appended as a contact with depth <n_i, x_i - v_i> and gradient -n_i.
///
/// The constraint is appended only if v_i lies above the patch by at most the margin, or below the patch by at most a
/// tenth of the spacing of the points. A patch outside this range belongs to another part of the surface, such as the
/// other side of a rim. Called after ToolShape::surface_constraints. Precondition: `contacts` has room for twice its
/// size. O(n).
void ShellConstraints::add_edges(const ToolPose& proxy, ContactBuffer& contacts) noexcept {
  const std::size_t points = contacts.size(), padded = contacts.padded_size();
  const PackRange all{0, padded / simd::lanes, 0xff, static_cast<std::uint8_t>(0xffu >> (padded - points))};
  const PointColumns columns{contacts.index.data(), contacts.x.data(),  contacts.y.data(), contacts.z.data(),
                             contacts.nx.data(),    contacts.ny.data(), contacts.nz.data()};
  const Pack highest(margin_), deepest(-kMaxPatchDepth * spacing_), patch2(kPatch * spacing_ * kPatch * spacing_);
  const MutablePointArrays support{support_x_.data(), support_y_.data(), support_z_.data()};
  tool_->support_points(proxy, contacts, support);
  // Append the constraint of each contact's patch if the projection of the contact's support point lies on the patch.
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
    // If the depth is NaN, both conditions are false, and the spring adds no constraint.
    if (depth > -kNever) push_spring(j, proxy.position, depth, u, contacts);
    if (springs_->bilateral && -depth > -kNever) push_spring(j, proxy.position, -depth, -u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

}  // namespace hapbench
