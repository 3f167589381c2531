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

/// Table of the force algorithms. Each built-in algorithm has a source file that defines its AlgorithmEntry, and a name
/// in the list in registry.cpp. `add_algorithm` adds an external algorithm while the program runs.
///
/// The process has one table. The scenario reader, the schema, the help texts and the factories look algorithms up in
/// this table. A module adds its algorithm to the table; the process loads the code of a module only once. With one
/// table for each run, every function that visits scenario fields would need the table as an argument.
namespace hapbench {

/// A numeric parameter that belongs to one algorithm only and is not a member of RenderingConfig. A scenario sets the
/// parameter in the field rendering.parameters.<algorithm>.<name>.
struct AlgorithmParameter {
  const char* name;
  NumberRange range;
  double initial;  ///< default value
  const char* meaning;
};

/// Returns the parameter's value in `config`, or its default.
double parameter_value(const RenderingConfig& config, const char* algorithm, const AlgorithmParameter& parameter);

/// Function for AlgorithmEntry::force_bound. Returns the force divided by K [m] of min(count, n) parallel springs that
/// all have the depth `depth` [m]. Without `count`, all n springs are included.
template <int count = std::numeric_limits<int>::max()>
double bound_of_springs(const RenderingConfig&, const ToolShape&, std::size_t n, double depth) {
  return std::min<double>(count, static_cast<double>(n)) * depth;
}

/// The file from which an external algorithm was loaded, for the provenance of results.
struct AlgorithmOrigin {
  std::string file;  ///< file name without folders
  std::string hash;  ///< hash of the file's content
};

/// Describes an algorithm: its documentation, the function that creates the algorithm, and the upper bound of its
/// force. Exactly one of `make_law` and `make` is set.
struct AlgorithmEntry {
  const ModelInfo* info;
  /// Creates the force law for one run. PenaltyRendering adds the stages around the law.
  std::function<std::unique_ptr<ForceLaw>(const RenderingConfig&)> make_law = {};
  /// Creates an algorithm that is not a force law, for one run.
  std::function<std::unique_ptr<ForceAlgorithm>(const RenderingConfig&)> make = {};
  /// Upper bound of |f_spring| / K [m] in the first step after a reset, with n contacts and the largest depth `depth`
  /// [m]; null if unknown. The derivation is documented with the algorithm.
  double (*force_bound)(const RenderingConfig& config, const ToolShape& tool, std::size_t n, double depth) = nullptr;
  /// Depth model that is part of the algorithm's definition; empty if the scenario chooses it.
  std::string_view fixed_depth_model = {};
  /// False if the algorithm's definition excludes the point reduction; with_fixed_stages() then removes the reduction.
  bool may_reduce = true;
  /// Depth model whose depths are reported in the results, for an algorithm that does not use depths for its force;
  /// empty if the algorithm uses the depths.
  std::string_view reported_depth_model = {};
  std::span<const AlgorithmParameter> algorithm_parameters = {};
  AlgorithmOrigin origin = {};  ///< empty for a built-in algorithm
  /// Keeps alive the texts to which `info` and `algorithm_parameters` of an external algorithm point.
  std::shared_ptr<const void> texts = {};

  /// Returns false for a built-in algorithm.
  bool is_external() const noexcept { return texts != nullptr; }
};

/// Function for AlgorithmEntry::make_law. Creates an object of the class `Law` from the configuration.
template <class Law>
std::unique_ptr<ForceLaw> law_of(const RenderingConfig& config) {
  return std::make_unique<Law>(config);
}

/// Returns the table. References stay valid when an algorithm is added.
const std::deque<AlgorithmEntry>& algorithms();
/// Returns the names of the algorithms, in the order of algorithms().
std::vector<std::string> algorithm_names();
/// Returns the documentation of the stages that can run before and after a force law.
std::span<const ModelInfo* const> stages();

/// Returns the entry of the algorithm with this name; null if no algorithm has this name.
const AlgorithmEntry* find_algorithm(std::string_view name);

/// Returns a copy of the entry. The copy owns copies of all texts of the entry except `info->parameters`. Throws
/// std::invalid_argument with the reason if a name is not allowed in a scenario, a text is missing, or a
/// parameter has no valid range.
AlgorithmEntry checked_copy(AlgorithmEntry entry);

/// Adds a checked copy of an external algorithm. It replaces an earlier external algorithm with the same name.
/// Must not be called while another thread reads the table. Throws std::invalid_argument like checked_copy, and
/// for the name of a built-in algorithm.
void add_algorithm(AlgorithmEntry entry);

/// Returns the number of successful add_algorithm calls. Data derived from the table is valid until this number
/// changes.
std::size_t additions();

/// Returns the values of `entry.algorithm_parameters`, in their order. A parameter that `config` does not set has its
/// default value.
std::vector<double> parameter_values(const RenderingConfig& config, const AlgorithmEntry& entry);

/// Returns `config` with the depth model and the reduction that its algorithm prescribes. Precondition: the
/// algorithm exists.
RenderingConfig with_fixed_stages(RenderingConfig config);

/// Creates the depth model of the contacts that the algorithm of `config` receives. Throws
/// std::invalid_argument for unknown names.
std::unique_ptr<DepthModel> make_depth_model(const RenderingConfig& config);

/// Creates the force law with this name, without the stages around it. Throws std::invalid_argument if there is
/// no such law.
std::unique_ptr<ForceLaw> make_law(std::string_view name, const RenderingConfig& config);

/// Creates the algorithm of `config` with the stages that the algorithm prescribes, followed by the force stage and by
/// the passivity controller, each only if `config` sets it. Throws std::invalid_argument for unknown names.
std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config);

}  // namespace hapbench
