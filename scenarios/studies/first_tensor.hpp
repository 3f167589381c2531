#pragma once

#include "sim/loop/observer.hpp"

namespace hapbench {

/// Keeps the stiffness tensor of the first row.
class FirstTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    if (record.step == 0) S = record.force.S;
  }
  Mat3 S = Mat3::Zero();
};

}  // namespace hapbench
