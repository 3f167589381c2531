#include "device_model/theory/eigenvalue_edge.hpp"

#include <Eigen/Eigenvalues>

namespace hapbench {

double spectral_radius(const Eigen::MatrixXd& A) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace hapbench
