#include "results/record/ratio_recorder.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "sim/contact/stiffness_tensor.hpp"

namespace hapbench {
namespace {

std::vector<int> ascending_unique(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

RatioRecorder::RatioRecorder(TableTarget target, std::uint64_t every, std::vector<int> iterations,
                             ShapingOperations shaping, std::size_t capacity)
    : writer_(std::move(target), kColumns),
      every_(every),
      iterations_(ascending_unique(std::move(iterations))),
      shaping_(shaping),
      contacts_(capacity) {
  assert(every > 0 && (iterations_.empty() || iterations_.front() >= 0));
}

void RatioRecorder::on_step(const StepRecord& record) noexcept {
  const ContactBuffer& rendered = *record.rendered;
  if (!is_recorded(record, every_) || rendered.empty()) return;
  assert(rendered.size() <= contacts_.capacity());

  contacts_.assign(rendered);
  // From each requested count on to the next.
  Mat3 S = shaping_.start(contacts_);
  int done = 0;
  for (const int m : iterations_) {
    for (; done < m; ++done) S = shaping_.update(contacts_, S);
    const RatioRange ratio = ratio_range(contacts_, S);
    writer_.row(record.step, record.time, static_cast<std::uint64_t>(m), contacts_.size(), ratio.min, ratio.max,
                lambda_max(S));
  }
}

}  // namespace hapbench
