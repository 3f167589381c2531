#include "sim/contact/contact_buffer.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

using simd::load, simd::Pack;

using Buffer = ContactBuffer;
constexpr AlignedDoubles Buffer::*kColumns[] = {&Buffer::x,  &Buffer::y,     &Buffer::z,     &Buffer::nx,
                                                &Buffer::ny, &Buffer::nz,    &Buffer::ux,    &Buffer::uy,
                                                &Buffer::uz, &Buffer::depth, &Buffer::weight};

/// Returns sum factor(i) u_i u_i^T. Computes one SIMD pack at a time.
template <class Factor>
Mat3 tensor_of(const ContactBuffer& contacts, const Factor& factor) {
  Pack xx(0.0), xy(0.0), xz(0.0), yy(0.0), yz(0.0), zz(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    const Pack c = factor(i);
    const Pack cx = c * x, cy = c * y;
    xx += cx * x;
    xy += cx * y;
    xz += cx * z;
    yy += cy * y;
    yz += cy * z;
    zz += c * z * z;
  }
  Mat3 S;
  S(0, 0) = simd::sum(xx);
  S(0, 1) = S(1, 0) = simd::sum(xy);
  S(0, 2) = S(2, 0) = simd::sum(xz);
  S(1, 1) = simd::sum(yy);
  S(1, 2) = S(2, 1) = simd::sum(yz);
  S(2, 2) = simd::sum(zz);
  return S;
}

}  // namespace

ContactBuffer::ContactBuffer(std::size_t capacity) : capacity_(capacity) {
  // One pack more than the capacity, because searches write whole packs behind the last contact.
  const std::size_t padded = simd::padded(capacity) + simd::lanes;
  index.assign(padded, 0);
  for (const auto column : kColumns) (this->*column).assign(padded, 0.0);
}

void ContactBuffer::push(std::uint32_t i, const Vec3& point, const Vec3& normal) {
  const std::size_t k = size_++;
  index[k] = i;
  x[k] = point.x();
  y[k] = point.y();
  z[k] = point.z();
  nx[k] = normal.x();
  ny[k] = normal.y();
  nz[k] = normal.z();
  depth[k] = ux[k] = uy[k] = uz[k] = weight[k] = 0.0;
}

void ContactBuffer::assign(const ContactBuffer& other) {
  clear();
  for (std::size_t i = 0; i < other.size(); ++i) push_copy_of(other, i);
  pad();
}

void ContactBuffer::copy(const ContactBuffer& other, std::size_t from, std::size_t to) {
  index[to] = other.index[from];
  for (const auto column : kColumns) (this->*column)[to] = (other.*column)[from];
}

void ContactBuffer::pad() {
  simd::zero_pack(&depth[size_]);
  simd::zero_pack(&ux[size_]);
  simd::zero_pack(&uy[size_]);
  simd::zero_pack(&uz[size_]);
  simd::zero_pack(&weight[size_]);
}

double ContactBuffer::largest_depth() const noexcept {
  if (empty()) return 0.0;
  const Pack lowest(-std::numeric_limits<double>::infinity());
  Pack largest = lowest;
  // Maximum over the whole packs.
  const std::size_t whole = size_ / simd::lanes * simd::lanes;
  for (std::size_t i = 0; i < whole; i += simd::lanes) largest = simd::max(largest, simd::load(&depth[i]));
  // Maximum over the last pack without its padding.
  if (whole < size_) {
    const simd::Mask in_use = simd::lanes_between(0, size_ - whole);
    largest = simd::max(largest, simd::select(in_use, simd::load(&depth[whole]), lowest));
  }
  return simd::max_lane(largest);
}

Mat3 stiffness_tensor(const ContactBuffer& contacts) {
  return tensor_of(contacts, [&](std::size_t i) { return load(&contacts.weight[i]); });
}

Mat3 load_tensor(const ContactBuffer& contacts) {
  return tensor_of(contacts, [&](std::size_t i) {
    return simd::max(load(&contacts.weight[i]) * load(&contacts.depth[i]), Pack(0.0));
  });
}

Vec3 weighted_depth(const ContactBuffer& contacts) {
  Pack gx(0.0), gy(0.0), gz(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack cd = load(&contacts.weight[i]) * load(&contacts.depth[i]);
    gx += cd * load(&contacts.ux[i]);
    gy += cd * load(&contacts.uy[i]);
    gz += cd * load(&contacts.uz[i]);
  }
  return {simd::sum(gx), simd::sum(gy), simd::sum(gz)};
}

RatioRange ratio_range(const ContactBuffer& contacts, const Mat3& S) {
  if (contacts.empty()) return {};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Pack smallest(infinity), largest(-infinity);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    // Same order of additions as Eigen's inner product, a + (b + c), so that results are bitwise identical.
    const auto along = [&](int row) { return Pack(S(row, 0)) * x + (Pack(S(row, 1)) * y + Pack(S(row, 2)) * z); };
    const Pack rho = x * along(0) + (y * along(1) + z * along(2));
    const simd::Mask in_use = simd::lanes_between(0, contacts.size() - i);  // excludes the padding
    smallest = simd::min(smallest, simd::select(in_use, rho, Pack(infinity)));
    largest = simd::max(largest, simd::select(in_use, rho, Pack(-infinity)));
  }
  return {simd::min_lane(smallest), simd::max_lane(largest)};
}

double lambda_max(const Mat3& S) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

}  // namespace hapbench
