#include "tests/support/dense_laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench::test {

Dense::Dense(const ContactBuffer& contacts)
    : U(3, static_cast<Eigen::Index>(contacts.size())), d(static_cast<Eigen::Index>(contacts.size())) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    U.col(static_cast<Eigen::Index>(i)) = contacts.gradient(i);
    d[static_cast<Eigen::Index>(i)] = contacts.depth[i];
  }
}

Eigen::VectorXd weights(const ContactBuffer& contacts) {
  Eigen::VectorXd c(static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) c[static_cast<Eigen::Index>(i)] = contacts.weight[i];
  return c;
}

Eigen::VectorXd shaped_weights(const Eigen::MatrixXd& A, int m) {
  Eigen::VectorXd c = Eigen::VectorXd::Ones(A.rows());
  for (int k = 0; k < m; ++k) c = c.cwiseQuotient(A * c).eval();
  return c;
}

ShapingOptimality shaping_optimality(const ContactBuffer& contacts, double eps) {
  using Real = long double;
  // Entries xx, yy, zz, xy, xz, yz of S.
  Real S[6] = {};
  Real c_squared = 0.0L;
  ShapingOptimality result;
  result.smallest_weight = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Real c = contacts.weight[i], x = contacts.ux[i], y = contacts.uy[i], z = contacts.uz[i];
    const Real products[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (int k = 0; k < 6; ++k) S[k] += c * products[k];
    c_squared += c * c;
    result.smallest_weight = std::min(result.smallest_weight, contacts.weight[i]);
    result.largest_weight = std::max(result.largest_weight, contacts.weight[i]);
  }
  result.ratio_margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Real c = contacts.weight[i], x = contacts.ux[i], y = contacts.uy[i], z = contacts.uz[i];
    const Real rho = S[0] * x * x + S[1] * y * y + S[2] * z * z + 2 * (S[3] * x * y + S[4] * x * z + S[5] * y * z);
    const Real lacking = x * x + y * y + z * z - rho;
    const Real violation = c > 0 ? std::abs(lacking - eps * c) : lacking;
    result.violation = std::max(result.violation, static_cast<double>(violation));
    result.ratio_margin = std::min(result.ratio_margin, static_cast<double>(eps * result.largest_weight - lacking));
  }
  const Real trace = S[0] + S[1] + S[2];
  const Real square = S[0] * S[0] + S[1] * S[1] + S[2] * S[2] + 2 * (S[3] * S[3] + S[4] * S[4] + S[5] * S[5]);
  result.trace_identity = static_cast<double>(std::abs(trace - square - eps * c_squared));
  return result;
}

}  // namespace hapbench::test
