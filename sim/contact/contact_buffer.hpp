#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Read-only view of shell points from which a search copies contacts: point numbers, positions [m] and unit
/// normals, world frame. One array per quantity, aligned and padded to whole SIMD packs (simd.hpp).
struct PointColumns {
  const std::uint32_t* index;
  const double *x, *y, *z, *nx, *ny, *nz;
};

/// The contacts of one step, one array per quantity. The memory is reused in every step. Order of use: the
/// contact search writes index, point and normal; the depth model writes depth and gradient; point stages merge
/// or drop contacts in place; the force law writes the spring weights.
///
/// Depth d_i [m] is the penetration depth, >= 0 for contacts with a surface; springs may have negative depths.
/// Gradient u_i is the unit vector along which the tool gets deeper: it points from the colliding point to
/// where this point would leave the tool. The penalty force of contact i on the tool is -K d_i u_i, with the
/// spring stiffness K [N/m].
///
/// Every array has room for the capacity, rounded up to whole SIMD packs, plus one pack. After `pad`, depth,
/// gradient and weight are zero beyond size(). Zero changes no sum, so loops over whole packs need no remainder
/// loop.
class ContactBuffer {
 public:
  /// Allocates all memory; no other function allocates. `capacity`: largest number of contacts that a search
  /// may return.
  explicit ContactBuffer(std::size_t capacity);

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t capacity() const { return capacity_; }
  /// Size rounded up to whole SIMD packs. Inline, because a call in a loop condition would spill the loop's
  /// registers.
  std::size_t padded_size() const { return simd::padded(size_); }

  void clear() { size_ = 0; }
  /// Appends a contact with zero depth, gradient and weight. Precondition: size() < capacity().
  void push(std::uint32_t index, const Vec3& point, const Vec3& normal);
  /// Increases size() by n. The caller has already written these n contacts behind the last contact. Precondition:
  /// size() + n <= capacity().
  void extend(std::size_t n) { size_ += n; }
  /// Appends a copy of contact `from` of another buffer. Precondition: size() < capacity().
  void push_copy_of(const ContactBuffer& other, std::size_t from) { copy(other, from, size_++); }
  /// Replaces the contents by the contacts of another buffer and calls pad(). Precondition: other.size() <= capacity().
  void assign(const ContactBuffer& other);
  /// Overwrites contact `to` with contact `from`.
  void copy(std::size_t from, std::size_t to) { copy(*this, from, to); }
  /// Keeps the first n contacts. Precondition: n <= size().
  void shrink(std::size_t n) { size_ = n; }
  /// Sets depth, gradient and weight to zero beyond size(), at least to the end of the last pack.
  void pad();

  /// Returns the largest depth [m], which may be negative; 0 without contacts. O(n).
  double largest_depth() const noexcept;

  Vec3 point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Vec3 normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
  Vec3 gradient(std::size_t i) const { return {ux[i], uy[i], uz[i]}; }
  void set_gradient(std::size_t i, const Vec3& u) {
    ux[i] = u.x();
    uy[i] = u.y();
    uz[i] = u.z();
  }

  std::vector<std::uint32_t> index;  ///< number of the shell point or spring
  AlignedDoubles x, y, z;            ///< colliding point, world [m]
  AlignedDoubles nx, ny, nz;         ///< unit outward normal of the environment's surface
  AlignedDoubles depth;              ///< penetration depth d_i [m]
  AlignedDoubles ux, uy, uz;         ///< gradient u_i, a unit vector
  AlignedDoubles weight;             ///< weight c_i that the force law gives the spring

 private:
  void copy(const ContactBuffer& other, std::size_t from, std::size_t to);

  std::size_t size_ = 0;
  std::size_t capacity_;
};

/// Returns the stiffness tensor S = sum c_i u_i u_i^T in units of the spring stiffness K, with the weights c_i
/// and gradients u_i in the buffer (thesis Eq. 3). S has six independent entries, so all stiffness ratios
/// together cost O(n). The thesis's n x n matrix of squared inner products is not needed. O(n). Precondition:
/// the contacts are padded (ContactBuffer::pad).
Mat3 stiffness_tensor(const ContactBuffer& contacts);

/// Returns sum c_i d_i u_i u_i^T [m] over the contacts with c_i d_i > 0. Multiplied by the spring stiffness K, this is
/// the tensor of the spring loads [N]; the trace of that tensor is the sum of the loads. O(n). Precondition: the
/// contacts are padded.
Mat3 load_tensor(const ContactBuffer& contacts);

/// Returns sum c_i d_i u_i [m], the rendered penetration depth vector (thesis Eq. 6). O(n). Precondition: the
/// contacts are padded.
Vec3 weighted_depth(const ContactBuffer& contacts);

/// Smallest and largest stiffness ratio over the contacts. The ratio rho_i = u_i^T S u_i is the rendered
/// stiffness along contact i divided by K (thesis Eq. 4).
struct RatioRange {
  double min = 0.0;
  double max = 0.0;
};
/// Returns the range of the stiffness ratios for the stiffness tensor S; zeros without contacts. O(n).
/// Precondition: the contacts are padded.
RatioRange ratio_range(const ContactBuffer& contacts, const Mat3& S);

/// Returns the largest eigenvalue of a symmetric matrix, exact to rounding. Iterative, about 0.3 us. The closed form
/// would lose half of the digits if the two largest eigenvalues are equal, which is the normal case after stiffness
/// shaping.
double lambda_max(const Mat3& S);

}  // namespace hapbench
