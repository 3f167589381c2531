#include <algorithm>

#include "algorithms/laws/averaged_direction.hpp"
#include "algorithms/laws/laws.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kHighestDepthParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kHighestDepthInfo = {
    .name = "highest_depth",
    .summary = "one spring, as deep as the deepest contact, along the averaged gradient",
    .formula =
        "u_r = sum u_i / |sum u_i|, d_r = max d_i, f = -K d_r u_r, S = u_r u_r^T; zero force when "
        "|sum u_i| <= 1e-9 n; always without reduction",
    .source = "thesis 4.1, which says of it (its reference 3) that it vibrates in a hole",
    .known_failure =
        "u_r turns round by 180 degrees as one of nearly opposite contacts comes or goes, and d_r jumps from contact "
        "to contact: the force jumps by up to 2 K d_r",
    .parameters = kHighestDepthParameters,
};

namespace {

class HighestDepth final : public AveragedDirectionLaw {
 public:
  using AveragedDirectionLaw::AveragedDirectionLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    return force_along_mean(contacts, [&contacts](double) {
      const auto depths = contacts.depth.begin();
      return *std::max_element(depths, depths + static_cast<std::ptrdiff_t>(contacts.size()));
    });
  }
};

/// d_r is one of the depths and u_r a unit vector.
double highest_depth_bound(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min(1.0, static_cast<double>(n)) * depth;
}

}  // namespace

const AlgorithmTheory kHighestDepthTheory = {.force_bound = highest_depth_bound,
                                             .wedge_stiffness = averaged_direction_wedge};

std::unique_ptr<ForceLaw> make_highest_depth(const RenderingConfig& config) {
  return std::make_unique<HighestDepth>(config.stiffness);
}

}  // namespace hapbench
