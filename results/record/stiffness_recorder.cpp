#include "results/record/stiffness_recorder.hpp"

#include <cassert>
#include <utility>

#include "sim/contact/stiffness_tensor.hpp"

namespace hapbench {

StiffnessRecorder::StiffnessRecorder(TableTarget target, std::uint64_t every)
    : writer_(std::move(target), kColumns), every_(every) {
  assert(every > 0);
}

void StiffnessRecorder::on_step(const StepRecord& record) noexcept {
  if (!is_recorded(record, every_)) return;
  const Mat3& S = record.force.S;
  writer_.row(record.step, record.time, S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2), lambda_max(S));
}

}  // namespace hapbench
