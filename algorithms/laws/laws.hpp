#pragma once

#include <span>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/own_parameter.hpp"
#include "algorithms/theory.hpp"

/// The force laws. Each is in the source file of its name: documentation, theory, class. Those with functions of their
/// own have a header too.
namespace hapbench {

extern const ModelInfo kContinuousNormalProjectionInfo;  ///< shaped_stiffness on a depth model of its own
extern const ModelInfo kExactShapingInfo;
extern const ModelInfo kHighestDepthInfo;
extern const ModelInfo kLeastSquaresInfo;
extern const ModelInfo kMcNeelyInfo;
extern const ModelInfo kMeanInfo;
extern const ModelInfo kMergedShapingInfo;
extern const ModelInfo kNormalProjectionInfo;  ///< shaped_stiffness on a depth model of its own
extern const ModelInfo kOriginalAveragingInfo;
extern const ModelInfo kShapedStiffnessInfo;
extern const ModelInfo kStaticCouplingInfo;
extern const ModelInfo kSummationInfo;
extern const ModelInfo kTandpastaInfo;
extern const ModelInfo kVirtualCouplingInfo;

extern const AlgorithmTheory kExactShapingTheory;  ///< of merged_shaping too
extern const AlgorithmTheory kHighestDepthTheory;
extern const AlgorithmTheory kLeastSquaresTheory;
extern const AlgorithmTheory kMcNeelyTheory;
extern const AlgorithmTheory kMeanTheory;
extern const AlgorithmTheory kOriginalAveragingTheory;
extern const AlgorithmTheory kShapedStiffnessTheory;
extern const AlgorithmTheory kStaticCouplingTheory;
extern const AlgorithmTheory kSummationTheory;
extern const AlgorithmTheory kTandpastaTheory;
extern const AlgorithmTheory kVirtualCouplingTheory;

extern const std::span<const OwnParameter> kMcNeelyOwnParameters;
extern const std::span<const OwnParameter> kStaticCouplingOwnParameters;

std::unique_ptr<ForceLaw> make_exact_shaping(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_highest_depth(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_least_squares(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_mcneely(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_mean(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_merged_shaping(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_original_averaging(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_shaped_stiffness(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_static_coupling(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_summation(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_tandpasta(const RenderingConfig& config);
std::unique_ptr<ForceLaw> make_virtual_coupling(const RenderingConfig& config);

}  // namespace hapbench
