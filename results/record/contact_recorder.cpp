#include "results/record/contact_recorder.hpp"

#include <cassert>
#include <utility>

namespace hapbench {

ContactRecorder::ContactRecorder(TableTarget target, std::uint64_t every)
    : writer_(std::move(target), kColumns), every_(every) {
  assert(every > 0);
}

void ContactRecorder::on_step(const StepRecord& record) noexcept {
  if (!is_recorded(record, every_)) return;
  const ContactBuffer& c = *record.rendered;
  for (std::size_t i = 0; i < c.size(); ++i) {
    writer_.row(record.step, record.time, std::uint64_t{c.index[i]}, c.point(i), c.normal(i), c.depth[i], c.gradient(i),
                c.weight[i]);
  }
}

}  // namespace hapbench
