#pragma once

#include <bit>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {

/// Appends those of the eight points from i on whose bit is set in `hits`, a column at a time: pushing them one by one
/// takes longer than the search. Depth, gradient and weight are left to depth model and law. For source files only (see
/// simd.hpp). Precondition: i is a multiple of eight, and there is room for the hits.
inline void push_hits(std::uint8_t hits, const PointColumns& points, std::size_t i, ContactBuffer& contacts) {
  const std::size_t k = contacts.size();
  simd::store_selected(hits, points.index + i, &contacts.index[k]);
  simd::store_selected(hits, points.x + i, &contacts.x[k]);
  simd::store_selected(hits, points.y + i, &contacts.y[k]);
  simd::store_selected(hits, points.z + i, &contacts.z[k]);
  simd::store_selected(hits, points.nx + i, &contacts.nx[k]);
  simd::store_selected(hits, points.ny + i, &contacts.ny[k]);
  simd::store_selected(hits, points.nz + i, &contacts.nz[k]);
  contacts.extend(static_cast<std::size_t>(std::popcount(hits)));
}

}  // namespace hapbench
