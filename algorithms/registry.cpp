#include "algorithms/registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "algorithms/added_algorithm.hpp"
#include "algorithms/depth/continuous_normal_projection_depth.hpp"
#include "algorithms/depth/normal_projection_depth.hpp"
#include "algorithms/depth/shortest_distance.hpp"
#include "algorithms/depth/surface_normal.hpp"
#include "algorithms/laws/laws.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/proxy/proxy_rendering.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "algorithms/stages/gradient_reduction.hpp"
#include "algorithms/stages/local_average.hpp"
#include "algorithms/stages/passivity_controller.hpp"

namespace hapbench {
namespace {

/// A force law on the penalty pipeline.
template <auto make_law>
std::unique_ptr<ForceAlgorithm> penalty(const RenderingConfig& config) {
  return std::make_unique<PenaltyRendering>(make_law(config), config);
}

std::deque<AlgorithmEntry> built_in() {
  return {
      {.info = &kOriginalAveragingInfo,
       .make = penalty<make_original_averaging>,
       .theory = &kOriginalAveragingTheory,
       .fixed_depth_model = "shortest_distance",
       .may_reduce = false,
       .creates_energy = true},
      {.info = &kSummationInfo, .make = penalty<make_summation>, .theory = &kSummationTheory, .creates_energy = true},
      {.info = &kMeanInfo, .make = penalty<make_mean>, .theory = &kMeanTheory},
      {.info = &kVirtualCouplingInfo, .make = penalty<make_virtual_coupling>, .theory = &kVirtualCouplingTheory},
      {.info = &kShapedStiffnessInfo, .make = penalty<make_shaped_stiffness>, .theory = &kShapedStiffnessTheory},
      {.info = &kTandpastaInfo, .make = penalty<make_tandpasta>, .theory = &kTandpastaTheory, .creates_energy = true},
      {.info = &kNormalProjectionInfo,
       .make = penalty<make_shaped_stiffness>,
       .theory = &kShapedStiffnessTheory,
       .fixed_depth_model = "normal_projection",
       .creates_energy = true},
      {.info = &kExactShapingInfo, .make = penalty<make_exact_shaping>, .theory = &kExactShapingTheory},
      {.info = &kContinuousNormalProjectionInfo,
       .make = penalty<make_shaped_stiffness>,
       .theory = &kShapedStiffnessTheory,
       .fixed_depth_model = "continuous_normal_projection"},
      {.info = &kMergedShapingInfo,
       .make = penalty<make_merged_shaping>,
       .theory = &kExactShapingTheory,
       .may_reduce = false},
      {.info = &kProxyInfo,
       .make = make_proxy,
       .theory = &kProxyTheory,
       .may_reduce = false,
       .reported_depth_model = "surface_normal"},
      {.info = &kLeastSquaresInfo,
       .make = penalty<make_least_squares>,
       .theory = &kLeastSquaresTheory,
       .may_reduce = false},
      {.info = &kHighestDepthInfo,
       .make = penalty<make_highest_depth>,
       .theory = &kHighestDepthTheory,
       .may_reduce = false},
      {.info = &kMcNeelyInfo,
       .make = penalty<make_mcneely>,
       .theory = &kMcNeelyTheory,
       .may_reduce = false,
       .creates_energy = true,
       .own_parameters = kMcNeelyOwnParameters},
      {.info = &kStaticCouplingInfo,
       .make = penalty<make_static_coupling>,
       .theory = &kStaticCouplingTheory,
       .may_reduce = false,
       .own_parameters = kStaticCouplingOwnParameters},
  };
}

/// The table, built at the first use: others may ask before this file's variables are.
struct Table {
  std::deque<AlgorithmEntry> entries = built_in();
  std::size_t built_in_size = entries.size();
  std::vector<std::string> names;
  std::size_t additions = 0;

  Table() {
    for (const AlgorithmEntry& entry : entries) names.emplace_back(entry.info->name);
  }
};

Table& table() {
  static Table the_one;
  return the_one;
}

constexpr DepthModelEntry kDepthModels[] = {
    {&kShortestDistanceInfo, make_shortest_distance},
    {&kSurfaceNormalInfo, make_surface_normal},
    {&kNormalProjectionDepthInfo, make_normal_projection_depth},
    {&kContinuousNormalProjectionDepthInfo, make_continuous_normal_projection_depth},
};

constexpr const ModelInfo* kStages[] = {&kLocalAverageInfo, &kGradientReductionInfo, &kDampingAndLimitsInfo,
                                        &kPassivityControllerInfo};

template <class Entries>
auto* find(Entries& entries, std::string_view name) {
  const auto found =
      std::find_if(std::begin(entries), std::end(entries), [name](auto& e) { return e.info->name == name; });
  return found == std::end(entries) ? nullptr : &*found;
}

const AlgorithmEntry& algorithm_entry(const RenderingConfig& config) {
  const AlgorithmEntry* entry = find_algorithm(config.algorithm);
  if (entry == nullptr) throw std::invalid_argument("unknown algorithm " + config.algorithm);
  return *entry;
}

}  // namespace

const std::deque<AlgorithmEntry>& algorithms() {
  return table().entries;
}

const std::vector<std::string>& algorithm_names() {
  return table().names;
}

std::span<const DepthModelEntry> depth_models() {
  return kDepthModels;
}

std::span<const ModelInfo* const> stages() {
  return kStages;
}

const AlgorithmEntry* find_algorithm(std::string_view name) {
  return find(table().entries, name);
}

const DepthModelEntry* find_depth_model(std::string_view name) {
  return find(kDepthModels, name);
}

void add_algorithm(AlgorithmEntry entry) {
  entry = checked_copy(std::move(entry));
  auto& [entries, built_in_size, names, count] = table();
  AlgorithmEntry* same = find(entries, entry.info->name);
  if (same == nullptr) {
    names.emplace_back(entry.info->name);
    entries.push_back(std::move(entry));
    ++count;
    return;
  }
  const auto first_added = entries.begin() + static_cast<std::ptrdiff_t>(built_in_size);
  if (std::none_of(first_added, entries.end(), [same](const AlgorithmEntry& e) { return &e == same; }))
    throw std::invalid_argument("\"" + std::string(entry.info->name) + "\" is the name of a built-in algorithm");
  *same = std::move(entry);
  ++count;
}

std::size_t additions() {
  return table().additions;
}

std::vector<double> own_values(const RenderingConfig& config, const AlgorithmEntry& entry) {
  std::vector<double> values;
  for (const OwnParameter& p : entry.own_parameters) values.push_back(own_value(config, entry.info->name, p));
  return values;
}

RenderingConfig with_fixed_stages(RenderingConfig config) {
  const AlgorithmEntry& entry = *find_algorithm(config.algorithm);
  if (!entry.fixed_depth_model.empty()) config.depth_model = entry.fixed_depth_model;
  if (!entry.may_reduce) config.reduction.reset();
  return config;
}

std::unique_ptr<DepthModel> make_depth_model(const RenderingConfig& config) {
  const std::string_view reported = algorithm_entry(config).reported_depth_model;
  const std::string name = reported.empty() ? with_fixed_stages(config).depth_model : std::string(reported);
  const DepthModelEntry* entry = find_depth_model(name);
  if (entry == nullptr) throw std::invalid_argument("unknown depth model " + name);
  return entry->make();
}

std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config) {
  auto algorithm = algorithm_entry(config).make(with_fixed_stages(config));
  if (!config.passivity_controller) return algorithm;
  return std::make_unique<PassivityController>(std::move(algorithm), config);
}

}  // namespace hapbench
