#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// Device, hand and wall of a scenario as a linear loop, as it is while nothing saturates and the contact lasts.
struct DeviceLoop {
  std::variant<SampledLoop, AdmittanceLoop> loop;
  std::string no_theory;  ///< why the loop's eigenvalues do not tell its stability; empty where they do

  Eigen::MatrixXd state_matrix() const {
    return std::visit([](const auto& linear) { return linear.state_matrix(); }, loop);
  }
};

/// The loop along a direction in which the springs' tensor has the eigenvalue lambda: the wall is lambda K, lambda B.
/// Precondition: the device is not ideal; that has no loop of its own.
DeviceLoop device_loop(const Scenario& scenario, double lambda);

}  // namespace hapbench
