#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/laws/force_law.hpp"
#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"

/// The table of algorithms. An algorithm of this tree is a source file that defines its AlgorithmEntry and a row in
/// registry.cpp; `add_algorithm` adds one from outside while the program runs.
///
/// The table belongs to the process. It decides which scenarios can be read: reader, schema, help and the factories
/// look names up in it, and modules, whose code a process loads once, add to it. Several tables would have to pass
/// through every visitor of fields and would all hold the same.
namespace hapbench {

/// A parameter that belongs to one algorithm alone and is not a member of RenderingConfig: a number, the field
/// rendering.parameters.<algorithm>.<name> of a scenario.
struct OwnParameter {
  const char* name;
  NumberRange range;
  double initial;  ///< default
  const char* meaning;
};

/// The value in `config`, or the default.
double own_value(const RenderingConfig& config, const char* algorithm, const OwnParameter& parameter);

/// AlgorithmEntry::force_bound of springs that pull at most like `most` of them; without a number, of all that there
/// are.
template <int most = std::numeric_limits<int>::max()>
double bound_of_springs(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min<double>(most, static_cast<double>(n)) * depth;
}

/// The file that an algorithm from outside was loaded from, for the provenance of results.
struct AlgorithmOrigin {
  std::string file;  ///< name without folders
  std::string hash;  ///< hash of its content
};

/// An algorithm: documentation, how to make it, bound of its force. Either `make_law` or `make` is given.
struct AlgorithmEntry {
  const ModelInfo* info;
  /// Makes a force law for one run, which PenaltyRendering uses.
  std::function<std::unique_ptr<ForceLaw>(const RenderingConfig&)> make_law = {};
  /// Makes an algorithm that is not a force law, for one run.
  std::function<std::unique_ptr<ForceAlgorithm>(const RenderingConfig&)> make = {};
  /// The largest |f_spring| / K [m] that n contacts, the deepest of them by `depth` [m], may cause in one step; null if
  /// unknown. The derivation stands with the algorithm.
  double (*force_bound)(const RenderingConfig& config, const ToolShape& tool, std::size_t n, double depth) = nullptr;
  /// The depth model that is part of the algorithm's definition; empty if the scenario chooses.
  std::string_view fixed_depth_model = {};
  /// False if the algorithm's definition excludes the reduction.
  bool may_reduce = true;
  /// The depth model of contacts whose depths the algorithm only reports; empty if it renders them.
  std::string_view reported_depth_model = {};
  std::span<const OwnParameter> own_parameters = {};
  AlgorithmOrigin origin = {};             ///< empty for a built-in algorithm
  std::shared_ptr<const void> texts = {};  ///< owns the targets of `info` and `own_parameters` of an added algorithm
};

/// AlgorithmEntry::make_law of a class that is constructed from the configuration.
template <class Law>
std::unique_ptr<ForceLaw> law_of(const RenderingConfig& config) {
  return std::make_unique<Law>(config);
}

/// References stay valid when an algorithm is added.
const std::deque<AlgorithmEntry>& algorithms();
/// Names of the algorithms, in the order of algorithms().
std::vector<std::string> algorithm_names();
/// The optional stages of the penalty pipeline, for the documentation.
std::span<const ModelInfo* const> stages();

/// Null if there is no algorithm of that name.
const AlgorithmEntry* find_algorithm(std::string_view name);

/// Returns the entry with copies of its texts, which it owns, but for `info->parameters`. Throws std::invalid_argument,
/// which says what is wrong, for a name that a scenario cannot hold, missing texts, and parameters without a valid
/// range.
AlgorithmEntry checked_copy(AlgorithmEntry entry);

/// Adds a checked copy of an algorithm from outside; it replaces one that was added earlier under the same name. Must
/// not be called while another thread reads the table. Throws std::invalid_argument as checked_copy does, and for the
/// name of a built-in algorithm.
void add_algorithm(AlgorithmEntry entry);

/// The number of add_algorithm calls. Data derived from the table is valid until it changes.
std::size_t additions();

/// Values of the algorithm's own parameters, in the order of its table: those in `config`, or the defaults.
std::vector<double> own_values(const RenderingConfig& config, const AlgorithmEntry& entry);

/// `config` with the depth model and the reduction that its algorithm fixes. Precondition: the name is known.
RenderingConfig with_fixed_stages(RenderingConfig config);

/// The depth model of the contacts that the algorithm of `config` receives. Throws std::invalid_argument for unknown
/// names.
std::unique_ptr<DepthModel> make_depth_model(const RenderingConfig& config);

/// The force law of that name alone, without the stages around it. Throws std::invalid_argument if there is none.
std::unique_ptr<ForceLaw> make_law(std::string_view name, const RenderingConfig& config);

/// The algorithm of `config` with its fixed stages, with its force stage and in a passivity controller if the
/// configuration asks for them. Throws std::invalid_argument for unknown names.
std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config);

}  // namespace hapbench
