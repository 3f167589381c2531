#include "tests/support/nonnegative_least_squares.hpp"

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

}  // namespace hapbench::test
