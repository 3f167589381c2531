#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

ContactBuffer::ContactBuffer(std::size_t capacity) : capacity_(capacity) {
  // Searches write whole packs behind the last contact.
  const std::size_t padded = simd::padded(capacity) + simd::lanes;
  index.assign(padded, 0);
  for (AlignedDoubles* column : {&x, &y, &z, &nx, &ny, &nz, &depth, &ux, &uy, &uz, &weight})
    column->assign(padded, 0.0);
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

void ContactBuffer::push_copy_of(const ContactBuffer& other, std::size_t from) {
  push(other.index[from], other.point(from), other.normal(from));
  const std::size_t k = size_ - 1;
  depth[k] = other.depth[from];
  set_gradient(k, other.gradient(from));
  weight[k] = other.weight[from];
}

void ContactBuffer::assign(const ContactBuffer& other) {
  clear();
  for (std::size_t i = 0; i < other.size(); ++i) push_copy_of(other, i);
  pad();
}

void ContactBuffer::copy(std::size_t from, std::size_t to) {
  index[to] = index[from];
  for (AlignedDoubles* column : {&x, &y, &z, &nx, &ny, &nz, &depth, &ux, &uy, &uz, &weight})
    (*column)[to] = (*column)[from];
}

void ContactBuffer::pad() {
  simd::zero_pack(&depth[size_]);
  simd::zero_pack(&ux[size_]);
  simd::zero_pack(&uy[size_]);
  simd::zero_pack(&uz[size_]);
  simd::zero_pack(&weight[size_]);
}

}  // namespace hapbench
