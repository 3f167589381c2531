#pragma once

#include <bit>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {

/// Copies the hits among the eight points from i on (bit k of `hits` stands for point i + k) to the places from k on of
/// columns with the same names, and returns their number. Copies column by column, because point by point takes longer
/// than the search. For source files only (see simd.hpp). Precondition: i is a multiple of eight, and there is room for
/// eight.
///
/// Always inline: searches would otherwise save and restore the packs in their registers around the call.
template <class Columns>
[[gnu::always_inline]] inline std::size_t copy_hits(std::uint8_t hits, const PointColumns& points, std::size_t i,
                                                    Columns& to, std::size_t k) {
  simd::store_selected(hits, points.index + i, &to.index[k]);
  simd::store_selected(hits, points.x + i, &to.x[k]);
  simd::store_selected(hits, points.y + i, &to.y[k]);
  simd::store_selected(hits, points.z + i, &to.z[k]);
  simd::store_selected(hits, points.nx + i, &to.nx[k]);
  simd::store_selected(hits, points.ny + i, &to.ny[k]);
  simd::store_selected(hits, points.nz + i, &to.nz[k]);
  return static_cast<std::size_t>(std::popcount(hits));
}

/// Appends the hits to the contacts. Depth, gradient and weight are left to the depth model and the law.
[[gnu::always_inline]] inline void push_hits(std::uint8_t hits, const PointColumns& points, std::size_t i,
                                             ContactBuffer& contacts) {
  contacts.extend(copy_hits(hits, points, i, contacts, contacts.size()));
}

}  // namespace hapbench
