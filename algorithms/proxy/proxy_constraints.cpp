#include "algorithms/proxy/proxy_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/contact/push_hits.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

/// The search looks a little further than the proxy moves, to allow for the rounding of both.
constexpr double kQueryMargin = 1.0 + 1e-6;
/// How far a point may lie inside one plane of an edge and still count as passing it, as a share of the spacing.
constexpr double kEdgeSlack = 1e-3;

/// Points whose spacing is measured.
constexpr std::size_t kSampled = 100;
/// Radius of a patch as a share of the spacing. It reaches the centre of four points of a square lattice, 0.707 away.
constexpr double kPatch = 0.75;
/// Largest depth at which an edge constraint applies, as a share of the spacing.
constexpr double kDeepest = 0.1;

/// Points nearer to each other than this share of the size of the shell count as one, because shells may list a vertex
/// once for each of its cells.
constexpr double kSamePlace = 1e-7;

/// Distance from a point to the second nearest other place [m].
double distance_to_second(const PointShell& shell, std::size_t from) {
  const double same = kSamePlace * (shell.bounds().max - shell.bounds().min).norm(), same2 = same * same;
  double first2 = std::numeric_limits<double>::infinity(), second2 = first2;
  const Vec3 here = shell.point(from).position;
  Vec3 nearest = here;
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const Vec3 place(shell.x()[i], shell.y()[i], shell.z()[i]);
    const double distance2 = (place - here).squaredNorm();
    if (distance2 >= second2 || distance2 <= same2 || (place - nearest).squaredNorm() <= same2) continue;
    if (distance2 < first2) {
      second2 = first2;
      first2 = distance2;
      nearest = place;
    } else {
      second2 = distance2;
    }
  }
  return std::sqrt(second2);
}

}  // namespace

double typical_spacing(const PointShell& shell) {
  if (shell.size() < 3) return 0.0;
  const std::size_t samples = std::min(kSampled, shell.size());
  std::vector<double> distances;
  for (std::size_t k = 0; k < samples; ++k) distances.push_back(distance_to_second(shell, k * shell.size() / samples));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(samples / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void add_edge_constraints(const ToolShape& tool, const ToolPose& pose, double spacing, double margin,
                          const PlaceArrays& places, ContactBuffer& contacts) noexcept {
  using simd::load, simd::Pack;
  const std::size_t points = contacts.size(), padded = contacts.padded_size();
  const PackRange all{0, padded / simd::lanes, 0xff, static_cast<std::uint8_t>(0xffu >> (padded - points))};
  const PointColumns columns{contacts.index.data(), contacts.x.data(),  contacts.y.data(), contacts.z.data(),
                             contacts.nx.data(),    contacts.ny.data(), contacts.nz.data()};
  const Pack highest(margin), deepest(-kDeepest * spacing), patch2(kPatch * spacing * kPatch * spacing);
  tool.foremost_places(pose, contacts, places);
  for (std::size_t i = 0; i < padded; i += simd::lanes) {
    const Pack nx = load(&contacts.nx[i]), ny = load(&contacts.ny[i]), nz = load(&contacts.nz[i]);
    const Pack dx = load(&places.x[i]) - load(&contacts.x[i]), dy = load(&places.y[i]) - load(&contacts.y[i]),
               dz = load(&places.z[i]) - load(&contacts.z[i]);
    const Pack height = nx * dx + ny * dy + nz * dz;
    const Pack aside2 = dx * dx + dy * dy + dz * dz - height * height;
    const simd::Mask applies = height <= highest && height >= deepest && aside2 <= patch2;
    const std::uint8_t patches = all.own(simd::bits(applies), i / simd::lanes);
    if (patches == 0) continue;
    const std::size_t to = contacts.size();
    push_hits(patches, columns, i, contacts);
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

ShellConstraints::ShellConstraints(const PointShell& shell, const ToolShape& tool, Skips skips)
    : tool_(&tool),
      margin_(kProxyMargin * tool.half_width()),
      spacing_(typical_spacing(shell)),
      reach_(tool.grown(margin_ * kQueryMargin)),
      near_(make_contact_query(shell, *reach_.shape, skips)),
      places_x_(simd::padded(near_->capacity())),
      places_y_(places_x_.size()),
      places_z_(places_x_.size()) {}

void ShellConstraints::constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept {
  near_->contacts_at({proxy.position + reach_.forward * proxy.axis, proxy.axis, proxy.roll}, contacts);
  tool_->surface_constraints(proxy, wanted, kEdgeSlack * spacing_, contacts);
  add_edge_constraints(*tool_, proxy, spacing_, margin_, {places_x_.data(), places_y_.data(), places_z_.data()},
                       contacts);
}

void SpringConstraints::constraints_at(const ToolPose& proxy, const Vec3&, ContactBuffer& contacts) noexcept {
  constexpr double never = -std::numeric_limits<double>::infinity();
  contacts.clear();
  for (std::size_t j = 0; j < springs_->gradients.size(); ++j) {
    const Vec3& u = springs_->gradients[j];
    const double depth = proxy.position.dot(u);
    // False for a position that is not finite, which compresses no spring.
    if (depth > never) push_spring(j, proxy.position, depth, u, contacts);
    if (springs_->bilateral && -depth > never) push_spring(j, proxy.position, -depth, -u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

std::size_t SpringConstraints::capacity() const noexcept {
  return springs_->gradients.size() * (springs_->bilateral ? 2 : 1);
}

double SpringConstraints::margin() const noexcept {
  return std::numeric_limits<double>::infinity();
}

}  // namespace hapbench
