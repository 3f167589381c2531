#include "tests/support/dense_laws.hpp"

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

Eigen::VectorXd tandpasta_weights(const Dense& contacts) {
  const Eigen::MatrixXd inner = contacts.U.transpose() * contacts.U;
  const Eigen::VectorXd beta = inner.rowwise().sum().cwiseAbs().cwiseQuotient(inner.cwiseAbs().rowwise().sum());
  const Eigen::VectorXd d2 = contacts.d.array().square();
  const double sigma = beta.dot(d2) / d2.sum();
  return sigma > 1e-12 ? Eigen::VectorXd(beta / sigma) : Eigen::VectorXd::Zero(contacts.n());
}

}  // namespace hapbench::test
