#include "sim/mesh/block_field.hpp"

namespace hapbench {

DensityField density_field(const BlockWithHole& block, double spacing, Density density) {
  DensityField field;
  field.signed_distance = [block](const Vec3& point) { return signed_distance(block, point); };
  field.min = {-block.size.x() / 2, -block.size.y() / 2, -block.size.z()};
  field.max = {block.size.x() / 2, block.size.y() / 2, 0.0};
  field.spacing = spacing;
  field.density = density;
  return field;
}

}  // namespace hapbench
