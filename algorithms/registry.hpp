#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/rendering_config.hpp"
#include "algorithms/theory.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/force_algorithm.hpp"

/// The one table of names. Adding an algorithm is one line in registry.cpp.
namespace hapbench {

struct AlgorithmEntry {
  const ModelInfo* info;
  /// A new force algorithm for one run.
  std::unique_ptr<ForceAlgorithm> (*make)(const RenderingConfig&);
  const AlgorithmTheory* theory = &kNoTheory;  ///< never null
  /// The depth model that is part of the algorithm's definition; empty when the scenario chooses.
  std::string_view fixed_depth_model = {};
  /// False when the algorithm's definition excludes the reduction.
  bool may_reduce = true;
  /// The depth model of contacts that an algorithm only reports the depths of; empty when it renders them.
  std::string_view reported_depth_model = {};
  /// True when the algorithm creates energy as a peg sticks in a hole; the passivity controller leaves the others
  /// alone.
  bool creates_energy = false;
};

struct DepthModelEntry {
  const ModelInfo* info;
  std::unique_ptr<DepthModel> (*make)();
};

std::span<const AlgorithmEntry> algorithms();
std::span<const DepthModelEntry> depth_models();
/// The other stages of the penalty pipeline, for the documentation.
std::span<const ModelInfo* const> stages();

/// Null when the table has no such name.
const AlgorithmEntry* find_algorithm(std::string_view name);
const DepthModelEntry* find_depth_model(std::string_view name);

/// `config` with what its algorithm fixes put in place: depth model and reduction. Precondition: the name is known.
RenderingConfig with_fixed_stages(RenderingConfig config);

/// The depth model of the contacts that the algorithm `config` names is given. Throws std::invalid_argument for unknown
/// names.
std::unique_ptr<DepthModel> make_depth_model(const RenderingConfig& config);

/// The algorithm `config` names, on the stages it fixes, in a passivity controller if asked for. Throws
/// std::invalid_argument for unknown names.
std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config);

}  // namespace hapbench
