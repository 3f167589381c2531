#include "sim/geometry/shell_bounds.hpp"

namespace hapbench {

Box bounds_of(const PointShell& shell) {
  if (shell.size() == 0) return {};
  Box box{shell.point(0).position, shell.point(0).position};
  for (std::size_t i = 1; i < shell.size(); ++i) {
    const Vec3 point = shell.point(i).position;
    box.min = box.min.cwiseMin(point);
    box.max = box.max.cwiseMax(point);
  }
  return box;
}

}  // namespace hapbench
