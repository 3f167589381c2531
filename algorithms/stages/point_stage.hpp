#pragma once

#include <cstdint>
#include <memory>

#include "algorithms/rendering_config.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// An optional stage between depth model and force law that merges or drops contacts in place (thesis C.2,
/// C.3).
class PointStage {
 public:
  virtual ~PointStage() = default;
  /// Only this function may allocate. Throws std::invalid_argument if the scene lacks data that the stage
  /// needs.
  virtual void prepare(const Scene& scene) = 0;
  /// Resets the stage to t = 0 and the number of dropped contacts to zero.
  virtual void reset() noexcept { dropped_ = 0; }
  /// Merges or drops contacts. The contacts are padded on entry and on return; their number never grows.
  virtual void process(ContactBuffer& contacts) noexcept = 0;
  /// Returns the number of contacts dropped because a buffer was full, since the last reset.
  std::uint64_t dropped() const noexcept { return dropped_; }

 protected:
  std::uint64_t dropped_ = 0;
};

extern const ModelInfo kLocalAverageInfo;
extern const ModelInfo kGradientReductionInfo;

/// Creates the local average. Its `prepare` needs a shell with grid cells (PointShell::cell_size > 0).
std::unique_ptr<PointStage> make_local_average();
std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config);

}  // namespace hapbench
