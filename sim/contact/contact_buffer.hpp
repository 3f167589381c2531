#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Points of a shell from which contacts are copied, with numbers and normals: one array per quantity, aligned and
/// padded to whole packs.
struct PointColumns {
  const std::uint32_t* index;
  const double *x, *y, *z, *nx, *ny, *nz;
};

/// The contacts of one step, one array per quantity, reused from step to step. The contact search fills index, point
/// and normal; the depth model fills depth and gradient; point stages compact the buffer in place; a force law fills
/// the weights of its springs.
///
/// Penetration depth d_i >= 0 (springs may have negative ones). Gradient u_i: unit vector from the colliding point to
/// where it would leave the tool, so that the tool gets deeper along +u_i and the penalty force on it is -K d_i u_i.
///
/// Arrays have room for whole packs and one more (see simd.hpp). After `pad`, depth, gradient and weight are zero
/// beyond size(), the neutral element of every sum, so that no loop needs a tail.
class ContactBuffer {
 public:
  /// Allocates; nothing else does. No contact search may return more than `capacity` contacts.
  explicit ContactBuffer(std::size_t capacity);

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t capacity() const { return capacity_; }
  /// Inline, because loops that end by it would otherwise spill their registers around the call.
  std::size_t padded_size() const { return simd::padded(size_); }

  void clear() { size_ = 0; }
  /// Appends a contact with zero depth, gradient and weight. Precondition: size() < capacity().
  void push(std::uint32_t index, const Vec3& point, const Vec3& normal);
  /// Includes the n contacts already written behind the last one. Precondition: there is room.
  void extend(std::size_t n) { size_ += n; }
  /// Appends a copy of contact `from` of another buffer. Precondition: size() < capacity().
  void push_copy_of(const ContactBuffer& other, std::size_t from) { copy(other, from, size_++); }
  /// Replaces the contents by the contacts of another buffer, padded. Precondition: other.size() <= capacity().
  void assign(const ContactBuffer& other);
  /// Overwrites contact `to` with contact `from`.
  void copy(std::size_t from, std::size_t to) { copy(*this, from, to); }
  /// Keeps the first n contacts. Precondition: n <= size().
  void shrink(std::size_t n) { size_ = n; }
  /// Zeroes depth, gradient and weight beyond size(), at least to the end of the last pack.
  void pad();

  /// The largest depth, possibly negative; 0 without contacts. O(n).
  double largest_depth() const noexcept;

  Vec3 point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Vec3 normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
  Vec3 gradient(std::size_t i) const { return {ux[i], uy[i], uz[i]}; }
  void set_gradient(std::size_t i, const Vec3& u) {
    ux[i] = u.x();
    uy[i] = u.y();
    uz[i] = u.z();
  }

  std::vector<std::uint32_t> index;  ///< of the shell point or spring
  AlignedDoubles x, y, z;            ///< colliding point, world [m]
  AlignedDoubles nx, ny, nz;         ///< outward surface normal of the environment
  AlignedDoubles depth;              ///< d_i [m]
  AlignedDoubles ux, uy, uz;         ///< gradient u_i
  AlignedDoubles weight;             ///< c_i of the force law

 private:
  void copy(const ContactBuffer& other, std::size_t from, std::size_t to);

  std::size_t size_ = 0;
  std::size_t capacity_;
};

/// The stiffness tensor S = sum c_i u_i u_i^T in units of K, from the buffer's weights (thesis Eq. 3). It has six
/// independent entries, so stiffness ratios cost O(n); the thesis's n x n matrix of squared inner products is never
/// built. O(n), as all of the following. Precondition of all: the contacts are padded (ContactBuffer::pad).
Mat3 stiffness_tensor(const ContactBuffer& contacts);

/// Sum of c_i d_i u_i u_i^T over the contacts with c_i d_i > 0 [m]; times K, the loads along their directions, whose
/// trace is their sum.
Mat3 load_tensor(const ContactBuffer& contacts);

/// Sum c_i d_i u_i [m]: the rendered penetration depth vector, thesis Eq. 6.
Vec3 weighted_depth(const ContactBuffer& contacts);

/// Smallest and largest stiffness ratio rho_i = u_i^T S u_i (thesis Eq. 4) over the contacts; zeros without contacts.
struct RatioRange {
  double min = 0.0;
  double max = 0.0;
};
RatioRange ratio_range(const ContactBuffer& contacts, const Mat3& S);

/// Largest eigenvalue of a symmetric matrix, to rounding. Iterative, about 0.3 us: the closed form loses half of the
/// digits if the largest eigenvalue is double, as it is for a well-shaped tensor.
double lambda_max(const Mat3& S);

}  // namespace hapbench
