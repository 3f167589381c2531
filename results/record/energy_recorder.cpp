#include "results/record/energy_recorder.hpp"

#include <cassert>
#include <optional>
#include <utility>

namespace hapbench {

EnergyRecorder::EnergyRecorder(TableTarget target, std::uint64_t every, const EnergyLedger& ledger)
    : writer_(std::move(target), kColumns), every_(every), ledger_(&ledger) {
  assert(every > 0);
}

void EnergyRecorder::on_step(const StepRecord& record) noexcept {
  if (!is_recorded(record, every_)) return;
  const EnergyBalance& b = ledger_->balance();
  const auto dissipated = b.device ? std::optional(b.device->dissipated) : std::nullopt;
  const auto stored = b.device ? std::optional(b.device->stored) : std::nullopt;
  writer_.row(record.step, record.time, b.kinetic, b.stored, b.input, b.spring, b.damping, b.rotation, b.created,
              b.integration, b.script, b.residual, b.hand, b.actuator, dissipated, stored);
}

}  // namespace hapbench
