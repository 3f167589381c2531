#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/own_parameter.hpp"
#include "algorithms/rendering_config.hpp"
#include "algorithms/theory.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/force_algorithm.hpp"

/// The one table of names. Adding an algorithm to the tree is one line in registry.cpp; `add_algorithm` adds one from
/// outside while the program runs.
namespace hapbench {

/// Where the code of an algorithm from outside comes from, for the provenance of results.
struct AlgorithmOrigin {
  std::string file;  ///< its name, without folders
  std::string hash;  ///< of its content
};

struct AlgorithmEntry {
  const ModelInfo* info;
  /// A new force algorithm for one run.
  std::function<std::unique_ptr<ForceAlgorithm>(const RenderingConfig&)> make;
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
  std::span<const OwnParameter> own_parameters = {};
  AlgorithmOrigin origin = {};             ///< empty for a built-in algorithm
  std::shared_ptr<const void> texts = {};  ///< what `info` and `own_parameters` of an added algorithm point to
};

struct DepthModelEntry {
  const ModelInfo* info;
  std::unique_ptr<DepthModel> (*make)();
};

/// References stay valid when an algorithm is added.
const std::deque<AlgorithmEntry>& algorithms();
/// Their names, in the same order.
const std::vector<std::string>& algorithm_names();
std::span<const DepthModelEntry> depth_models();
/// The other stages of the penalty pipeline, for the documentation.
std::span<const ModelInfo* const> stages();

/// Null when the table has no such name.
const AlgorithmEntry* find_algorithm(std::string_view name);
const DepthModelEntry* find_depth_model(std::string_view name);

/// Adds an algorithm from outside; one added earlier under the same name gives way to it. Texts are copied. Not while
/// another thread reads the table. Throws std::invalid_argument, which says what is wrong, for the name of a built-in
/// algorithm or one that a scenario cannot hold, for texts that are missing, and for parameters without a valid range.
void add_algorithm(AlgorithmEntry entry);

/// How often an algorithm has been added: what was made of the table holds until this changes.
std::size_t additions();

/// The values of the own parameters of an algorithm, in the order of its table: those `config` gives, or defaults.
std::vector<double> own_values(const RenderingConfig& config, const AlgorithmEntry& entry);

/// `config` with what its algorithm fixes put in place: depth model and reduction. Precondition: the name is known.
RenderingConfig with_fixed_stages(RenderingConfig config);

/// The depth model of the contacts that the algorithm `config` names is given. Throws std::invalid_argument for unknown
/// names.
std::unique_ptr<DepthModel> make_depth_model(const RenderingConfig& config);

/// The algorithm `config` names, on the stages it fixes, in a passivity controller if asked for. Throws
/// std::invalid_argument for unknown names.
std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config);

}  // namespace hapbench
