#pragma once

#include <Eigen/Dense>

namespace hapbench::test {

/// argmin |A c - b|^2 over c >= 0 by the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974,
/// chapter 23), each unconstrained problem by Householder QR. For small dense problems; A has full column rank.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace hapbench::test
