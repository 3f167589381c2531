#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "sim/core/simd.hpp"
#include "sim/tool/signed_distance_grid.hpp"
#include "sim/tool/tool_state.hpp"

/// Evaluates the field of a SignedDistanceGrid at points of the world. For source files only (see simd.hpp).
namespace hapbench {

/// Weights of the three nodes along an axis at t in [-1/2, 1/2] from the middle one; never negative.
struct QuadraticWeights {
  simd::Pack below, here, above;
  explicit QuadraticWeights(const simd::Pack& t)
      : below(simd::Pack(0.5) * (simd::Pack(0.5) - t) * (simd::Pack(0.5) - t)),
        here(simd::Pack(0.75) - t * t),
        above(simd::Pack(0.5) * (simd::Pack(0.5) + t) * (simd::Pack(0.5) + t)) {}
};

/// Maps the world to the coordinates of a grid's nodes at one pose: u = turn (x - position) + shift.
struct GridFrame {
  Mat3 turn;
  Vec3 position, shift;
  Vec3 last;  ///< largest coordinates with 27 nodes around the nearest one; the smallest are 1
  double spacing;
  double row, layer;  ///< difference between the indices of neighbours along y and x

  GridFrame(const SignedDistanceGrid& grid, const ToolPose& pose)
      : turn(pose.rotation().transpose() / grid.nodes().spacing),
        position(pose.position),
        shift(-grid.nodes().origin / grid.nodes().spacing),
        spacing(grid.nodes().spacing),
        row(static_cast<double>(grid.nodes().count[2])),
        layer(static_cast<double>(grid.nodes().count[1] * grid.nodes().count[2])) {
    for (int k = 0; k < 3; ++k) last[k] = static_cast<double>(grid.nodes().count[static_cast<std::size_t>(k)]) - 2.0;
  }
};

/// Eight points in the coordinates of the nodes.
struct GridPack {
  simd::Pack u, v, w;
  simd::Mask within;  ///< in the grid; false for coordinates that are not finite

  GridPack(const GridFrame& f, const double* px, const double* py, const double* pz) {
    using simd::Pack;
    const Pack x = simd::load(px) - Pack(f.position.x()), y = simd::load(py) - Pack(f.position.y()),
               z = simd::load(pz) - Pack(f.position.z());
    const auto along = [&](int k) {
      return Pack(f.turn(k, 0)) * x + Pack(f.turn(k, 1)) * y + Pack(f.turn(k, 2)) * z + Pack(f.shift[k]);
    };
    u = along(0);
    v = along(1);
    w = along(2);
    const Pack one(1.0);
    within =
        u >= one && u <= Pack(f.last.x()) && v >= one && v <= Pack(f.last.y()) && w >= one && w <= Pack(f.last.z());
  }

  /// Moves the points to the nearest places in the grid, NaN to its first corner. Returns the squared distances
  /// [spacings^2].
  simd::Pack clamp(const GridFrame& f) {
    using simd::Pack;
    Pack out2(0.0);
    const auto clamp_one = [&out2](Pack& coordinate, double last) {
      const Pack to = simd::select(coordinate > Pack(1.0), simd::min(coordinate, Pack(last)), Pack(1.0));
      out2 = out2 + (coordinate - to) * (coordinate - to);
      coordinate = to;
    };
    clamp_one(u, f.last.x());
    clamp_one(v, f.last.y());
    clamp_one(w, f.last.z());
    within = u >= Pack(1.0);
    return out2;
  }
};

/// Rounds numbers in [0, 2^51] to the nearest integer, halves to even: adding 1.5 * 2^52 leaves no bit for a fraction.
inline simd::Pack nearest_whole(const simd::Pack& a) {
  const simd::Pack big(0x1.8p52);
  return (a + big) - big;
}

/// The nodes nearest to eight points; the grid's first node for points that are not `within` it.
struct NearestNodes {
  simd::Pack i, j, k;

  NearestNodes(const GridFrame& f, const GridPack& q)
      : i(nearest_whole(q.u)), j(nearest_whole(q.v)), k(nearest_whole(q.w)) {
    const simd::Pack number = i * simd::Pack(f.layer) + j * simd::Pack(f.row) + k;
    // The low bits of a double above 2^52 are the integer itself, which saves a conversion.
    simd::store(simd::select(q.within, number, simd::Pack(0.0)) + simd::Pack(0x1p52), numbers_);
  }
  std::size_t operator[](std::size_t lane) const {
    return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(numbers_[lane]));
  }

 private:
  alignas(64) double numbers_[simd::lanes];
};

struct FieldValue {
  double value;   ///< phi_h [m]
  Vec3 gradient;  ///< with respect to the coordinates of the nodes [m]
};

/// phi_h at eight points within the grid. Computes the weights of all points at once and the sums point by point: rows
/// of three nodes are contiguous, so nine loads of four suffice for a point, while a gather would load all 27 nodes of
/// the eight points one by one.
class GridSpline {
 public:
  GridSpline(const SignedDistanceGrid& grid, const GridPack& q, const NearestNodes& nearest)
      : values_(grid.values()), row_(grid.nodes().count[2]), layer_(grid.nodes().count[1] * row_) {
    const simd::Pack t[] = {q.u - nearest.i, q.v - nearest.j, q.w - nearest.k};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const QuadraticWeights weights(t[axis]);
      simd::store(weights.below, weights_[axis][0]);
      simd::store(weights.here, weights_[axis][1]);
      simd::store(weights.above, weights_[axis][2]);
      simd::store(t[axis], t_[axis]);
    }
  }

  /// phi_h [m]; `node` is the one nearest to the point.
  double value(std::size_t lane, std::size_t node) const {
    const double* const corner = values_ + node - layer_ - row_ - 1;
    Four sum = {};
    for (std::size_t a = 0; a < 3; ++a) {
      Four layer = {};
      for (std::size_t b = 0; b < 3; ++b) {
        Four row;
        std::memcpy(&row, corner + a * layer_ + b * row_, sizeof(row));
        layer += weights_[1][b][lane] * row;
      }
      sum += weights_[0][a][lane] * layer;
    }
    return along_row(lane, sum);
  }

  FieldValue value_and_gradient(std::size_t lane, std::size_t node) const {
    const double x = t_[0][lane], y = t_[1][lane], z = t_[2][lane];
    const double slopes_x[] = {x - 0.5, -2.0 * x, x + 0.5}, slopes_y[] = {y - 0.5, -2.0 * y, y + 0.5};
    const double* const corner = values_ + node - layer_ - row_ - 1;
    Four sum = {}, by_x = {}, by_y = {};
    for (std::size_t a = 0; a < 3; ++a) {
      Four layer = {}, slope = {};
      for (std::size_t b = 0; b < 3; ++b) {
        Four row;
        std::memcpy(&row, corner + a * layer_ + b * row_, sizeof(row));
        layer += weights_[1][b][lane] * row;
        slope += slopes_y[b] * row;
      }
      sum += weights_[0][a][lane] * layer;
      by_x += slopes_x[a] * layer;
      by_y += weights_[0][a][lane] * slope;
    }
    const double by_z = (z - 0.5) * sum[0] - 2.0 * z * sum[1] + (z + 0.5) * sum[2];
    return {along_row(lane, sum), {along_row(lane, by_x), along_row(lane, by_y), by_z}};
  }

 private:
  /// Four numbers, added and multiplied element by element in every build.
  using Four [[gnu::vector_size(4 * sizeof(double))]] = double;

  double along_row(std::size_t lane, const Four& row) const {
    return weights_[2][0][lane] * row[0] + weights_[2][1][lane] * row[1] + weights_[2][2][lane] * row[2];
  }

  const double* values_;
  std::size_t row_, layer_;
  alignas(64) double weights_[3][3][simd::lanes];  ///< by axis, node and point
  alignas(64) double t_[3][simd::lanes];
};

}  // namespace hapbench
