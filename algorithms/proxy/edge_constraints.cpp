#include "algorithms/proxy/edge_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/contact/push_hits.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

using simd::load, simd::Pack;

constexpr std::size_t kSampled = 100;
/// Radius of a patch as a share of the spacing: reaches the centre of four points of a square lattice, 0.707 away.
constexpr double kPatch = 0.75;
/// Largest depth at which an edge constraint applies, as a share of the spacing.
constexpr double kDeepest = 0.1;

/// Nearer to each other than this part of the shell's size, points are one: shells may list a vertex once for each cell
/// that it belongs to.
constexpr double kSamePlace = 1e-7;

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

}  // namespace hapbench
