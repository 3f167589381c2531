#include "tests/support/dense_laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hapbench::test {
namespace {

/// The least-squares solution on the columns of `passive`, zero elsewhere.
Eigen::VectorXd solve_on(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const std::vector<Eigen::Index>& passive) {
  Eigen::MatrixXd columns(A.rows(), static_cast<Eigen::Index>(passive.size()));
  for (std::size_t k = 0; k < passive.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = A.col(passive[k]);
  const Eigen::VectorXd z = columns.householderQr().solve(b);
  Eigen::VectorXd c = Eigen::VectorXd::Zero(A.cols());
  for (std::size_t k = 0; k < passive.size(); ++k) c[passive[k]] = z[static_cast<Eigen::Index>(k)];
  return c;
}

}  // namespace

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

Eigen::VectorXd tandpasta_weights(const Dense& contacts) {
  const Eigen::MatrixXd inner = contacts.U.transpose() * contacts.U;
  const Eigen::VectorXd beta = inner.rowwise().sum().cwiseAbs().cwiseQuotient(inner.cwiseAbs().rowwise().sum());
  const Eigen::VectorXd d2 = contacts.d.array().square();
  const double sigma = beta.dot(d2) / d2.sum();
  return sigma > 1e-12 ? Eigen::VectorXd(beta / sigma) : Eigen::VectorXd::Zero(contacts.n());
}

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  // A column whose residual correlation is below rounding gains nothing.
  const double tolerance = 16 * std::numeric_limits<double>::epsilon() * A.norm() * b.norm();
  Eigen::VectorXd c = Eigen::VectorXd::Zero(A.cols());
  std::vector<Eigen::Index> passive;
  std::vector<bool> is_passive(static_cast<std::size_t>(A.cols()), false);
  // Each round adds one column for good or ends; three times the columns is the customary cap.
  for (Eigen::Index round = 0; round < 3 * A.cols(); ++round) {
    const Eigen::VectorXd gain = A.transpose() * (b - A * c);
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < A.cols(); ++i) {
      if (!is_passive[static_cast<std::size_t>(i)] && gain[i] > tolerance && (best < 0 || gain[i] > gain[best]))
        best = i;
    }
    if (best < 0) break;
    passive.push_back(best);
    is_passive[static_cast<std::size_t>(best)] = true;

    for (Eigen::VectorXd z = solve_on(A, b, passive);; z = solve_on(A, b, passive)) {
      double step = 1.0;
      for (const Eigen::Index i : passive) {
        if (z[i] <= 0.0) step = std::min(step, c[i] / (c[i] - z[i]));
      }
      if (step == 1.0) {
        c = z;
        break;
      }
      // Go as far as the first weight that reaches zero, and drop what is there.
      c += step * (z - c);
      std::erase_if(passive, [&](Eigen::Index i) {
        const bool out = c[i] <= tolerance && z[i] <= 0.0;
        if (out) {
          c[i] = 0.0;
          is_passive[static_cast<std::size_t>(i)] = false;
        }
        return out;
      });
    }
  }
  return c;
}

ShapingOptimality shaping_optimality(const ContactBuffer& contacts, double eps) {
  using Real = long double;
  // xx, yy, zz, xy, xz, yz of S.
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

double tensor_tolerance(std::size_t contacts, double violation, double eps) {
  return std::sqrt(static_cast<double>(contacts)) * violation / (2 * std::sqrt(eps));
}

double weight_tolerance(std::size_t contacts, double violation, double eps) {
  return std::sqrt(static_cast<double>(contacts)) * violation / eps;
}

}  // namespace hapbench::test
