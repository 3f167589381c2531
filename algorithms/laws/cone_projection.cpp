#include "algorithms/laws/cone_projection.hpp"

#include <Eigen/Cholesky>

namespace hapbench::cone_projection {

Vec6 solve_step(const Mat6& G, double eps, const Vec6& b) noexcept {
  return Eigen::LDLT<Mat6>(G + eps * Mat6::Identity()).solve(b);
}

}  // namespace hapbench::cone_projection
