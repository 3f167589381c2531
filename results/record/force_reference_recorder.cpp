#include "results/record/force_reference_recorder.hpp"

#include <optional>
#include <utility>

namespace hapbench {

ForceReferenceRecorder::ForceReferenceRecorder(TableTarget target, std::uint64_t every,
                                               const ForceFidelityObserver& observer)
    : writer_(std::move(target), kColumns), every_(every), observer_(&observer) {}

void ForceReferenceRecorder::on_step(const StepRecord& record) noexcept {
  if (!is_recorded(record, every_)) return;
  const std::optional<Vec3>& measured = observer_->reference();
  const auto part = [](const std::optional<Vec3>& v, int i) { return v ? std::optional((*v)[i]) : std::nullopt; };
  const auto error = measured ? std::optional<Vec3>(record.force.rendered - *measured) : std::nullopt;
  writer_.row(record.step, record.time, part(measured, 0), part(measured, 1), part(measured, 2), part(error, 0),
              part(error, 1), part(error, 2));
}

}  // namespace hapbench
