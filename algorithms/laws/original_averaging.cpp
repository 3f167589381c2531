#include <algorithm>

#include "algorithms/laws/averaged_direction.hpp"
#include "algorithms/laws/laws.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kOriginalAveragingParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kOriginalAveragingInfo = {
    .name = "original_averaging",
    .summary = "the trainer's original algorithm (DP): depths summed, gradients averaged",
    .formula =
        "u_r = sum u_i / |sum u_i|, d_r = sum d_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T; "
        "zero force when |sum u_i| <= 1e-9 n",
    .source = "thesis B.2, Eq. B.1; always with depth model shortest_distance and without reduction",
    .known_failure = "opposite gradients make d_r explode and u_r flip by 180 degrees (thesis B.3.3): vibration",
    .parameters = kOriginalAveragingParameters,
};

namespace {

class OriginalAveraging final : public AveragedDirectionLaw {
 public:
  using AveragedDirectionLaw::AveragedDirectionLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    return force_along_mean(contacts, [&contacts](double length) {
      simd::Pack depths(0.0);
      for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) depths += simd::load(&contacts.depth[i]);
      return simd::sum(depths) / length;
    });
  }
};

/// sum d_i / |sum u_i|, where |sum u_i| > kCancelledBelow n, or the force is zero.
double original_averaging_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return 1e9 * std::min(1.0, static_cast<double>(n)) * depth;
}

}  // namespace

const AlgorithmTheory kOriginalAveragingTheory = {.force_bound = original_averaging_bound,
                                                  .wedge_stiffness = averaged_direction_wedge};

std::unique_ptr<ForceLaw> make_original_averaging(const RenderingConfig& config) {
  return std::make_unique<OriginalAveraging>(config.stiffness);
}

}  // namespace hapbench
