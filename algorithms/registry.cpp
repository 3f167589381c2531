#include "algorithms/registry.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "algorithms/penalty_rendering.hpp"
#include "algorithms/stages/force_stage.hpp"
#include "algorithms/stages/passivity_controller.hpp"
#include "algorithms/stages/point_stage.hpp"

/// The algorithms in the order of lists. For each row, a source file in laws/ or proxy/ defines
/// `AlgorithmEntry <name>_entry()`.
#define HAPBENCH_ALGORITHMS(row)                                                                                 \
  row(original_averaging) row(summation) row(mean) row(virtual_coupling) row(shaped_stiffness) row(tandpasta)    \
      row(normal_projection) row(exact_shaping) row(continuous_normal_projection) row(merged_shaping) row(proxy) \
          row(least_squares) row(highest_depth) row(mcneely) row(static_coupling)

namespace hapbench {

#define HAPBENCH_DECLARE(name) AlgorithmEntry name##_entry();
HAPBENCH_ALGORITHMS(HAPBENCH_DECLARE)
#undef HAPBENCH_DECLARE

namespace {

/// The table, built at the first use because static variables of other files may ask for it.
struct Table {
#define HAPBENCH_ENTRY(name) name##_entry(),
  std::deque<AlgorithmEntry> entries = {HAPBENCH_ALGORITHMS(HAPBENCH_ENTRY)};
#undef HAPBENCH_ENTRY
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

constexpr const ModelInfo* kStages[] = {&kLocalAverageInfo, &kGradientReductionInfo,        &kDampingAndLimitsInfo,
                                        &kEnergyTankInfo,   &kActuatorLimitedPassivityInfo, &kPassivityControllerInfo};

const AlgorithmEntry& algorithm_entry(std::string_view name) {
  if (const AlgorithmEntry* entry = find_algorithm(name)) return *entry;
  throw std::invalid_argument("unknown algorithm " + std::string(name));
}

[[noreturn]] void refuse(const std::string& problem) {
  throw std::invalid_argument(problem);
}

/// True for a name that can be a field and a word of a list on the command line.
bool is_name(const char* text) {
  if (text == nullptr) return false;
  const std::string_view name = text;
  constexpr std::size_t kLongest = 64;
  return !name.empty() && name.size() <= kLongest && name[0] >= 'a' && name[0] <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == name.npos;
}

void require_text(const char* text, const std::string& what) {
  if (text == nullptr || *text == '\0') refuse(what + " is missing");
}

constexpr const char* kNames = "allowed: letters, digits and \"_\", a small letter first, at most 64";

void check(const OwnParameter& p) {
  if (!is_name(p.name)) refuse(std::string("a parameter is called \"") + (p.name ? p.name : "") + "\"; " + kNames);
  const std::string which = "parameter \"" + std::string(p.name) + "\": ";
  require_text(p.range.unit, which + "its unit");
  require_text(p.meaning, which + "its meaning");
  const auto& [min, max, unit, above_min] = p.range;
  if (!(std::isfinite(min) && std::isfinite(max) && min < max))
    refuse(which + "a range needs two finite ends, the lower first");
  if (!(p.initial <= max && (above_min ? p.initial > min : p.initial >= min)))
    refuse(which + "its default is out of its range");
}

/// Throws std::invalid_argument.
void check(const AlgorithmEntry& entry) {
  const ModelInfo& info = *entry.info;
  if (!is_name(info.name))
    refuse(std::string("an algorithm is called \"") + (info.name ? info.name : "") + "\"; " + kNames);
  // `--algorithms all` means all of them.
  if (info.name == std::string_view("all")) refuse("an algorithm is called \"all\", which means all of them");
  for (const auto& [what, text] :
       {std::pair{"its summary", info.summary}, std::pair{"its formula", info.formula},
        std::pair{"its source", info.source}, std::pair{"its known failure", info.known_failure}}) {
    require_text(text, what);
  }
  std::set<std::string_view> seen;
  for (const OwnParameter& p : entry.own_parameters) {
    check(p);
    if (!seen.insert(p.name).second) refuse("parameter \"" + std::string(p.name) + "\" is there twice");
  }
}

/// Owns the targets of `info` and `own_parameters` of an added algorithm.
struct Texts {
  std::deque<std::string> all;
  ModelInfo info = {};
  std::vector<ParameterInfo> parameters;
  std::vector<OwnParameter> own;

  const char* copy(const char* text) { return all.emplace_back(text).c_str(); }
  NumberRange copy(NumberRange range) {
    range.unit = copy(range.unit);
    return range;
  }
};

}  // namespace

double own_value(const RenderingConfig& config, const char* algorithm, const OwnParameter& parameter) {
  const auto own = config.parameters.find(algorithm);
  if (own == config.parameters.end()) return parameter.initial;
  const auto value = own->second.find(parameter.name);
  return value == own->second.end() ? parameter.initial : value->second;
}

const std::deque<AlgorithmEntry>& algorithms() {
  return table().entries;
}

const std::vector<std::string>& algorithm_names() {
  return table().names;
}

std::span<const ModelInfo* const> stages() {
  return kStages;
}

const AlgorithmEntry* find_algorithm(std::string_view name) {
  const std::deque<AlgorithmEntry>& entries = table().entries;
  const auto found = std::find_if(entries.begin(), entries.end(), [name](auto& e) { return e.info->name == name; });
  return found == entries.end() ? nullptr : &*found;
}

AlgorithmEntry checked_copy(AlgorithmEntry entry) {
  check(entry);
  auto texts = std::make_shared<Texts>();
  Texts& t = *texts;
  const ModelInfo& info = *entry.info;
  for (const auto& [parameter, meaning] : info.parameters)
    t.parameters.push_back({{t.copy(parameter.field), t.copy(parameter.range)}, t.copy(meaning)});
  for (const OwnParameter& p : entry.own_parameters)
    t.own.push_back(
        {.name = t.copy(p.name), .range = t.copy(p.range), .initial = p.initial, .meaning = t.copy(p.meaning)});
  t.info = {.name = t.copy(info.name),
            .summary = t.copy(info.summary),
            .formula = t.copy(info.formula),
            .source = t.copy(info.source),
            .known_failure = t.copy(info.known_failure),
            .parameters = t.parameters};
  entry.info = &t.info;
  entry.own_parameters = t.own;
  entry.texts = std::move(texts);
  return entry;
}

void add_algorithm(AlgorithmEntry entry) {
  entry = checked_copy(std::move(entry));
  auto& [entries, built_in_size, names, count] = table();
  const auto same = std::find(names.begin(), names.end(), entry.info->name);
  const auto place = static_cast<std::size_t>(same - names.begin());
  if (place < built_in_size) refuse("\"" + *same + "\" is the name of a built-in algorithm");
  ++count;
  if (same == names.end()) {
    names.emplace_back(entry.info->name);
    entries.push_back(std::move(entry));
  } else {
    entries[place] = std::move(entry);
  }
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
  const std::string_view reported = algorithm_entry(config.algorithm).reported_depth_model;
  return make_depth_model(reported.empty() ? with_fixed_stages(config).depth_model : reported);
}

std::unique_ptr<ForceLaw> make_law(std::string_view name, const RenderingConfig& config) {
  const AlgorithmEntry& entry = algorithm_entry(name);
  if (!entry.make_law) refuse(std::string(name) + " is not a force law");
  return entry.make_law(config);
}

std::unique_ptr<ForceAlgorithm> make_algorithm(const RenderingConfig& config) {
  const AlgorithmEntry& entry = algorithm_entry(config.algorithm);
  const RenderingConfig fixed = with_fixed_stages(config);
  std::unique_ptr<ForceAlgorithm> algorithm =
      entry.make_law ? std::make_unique<PenaltyRendering>(entry.make_law(fixed), fixed) : entry.make(fixed);
  if (config.force_stage)
    algorithm = std::make_unique<StagedRendering>(std::move(algorithm), make_force_stage(*config.force_stage), config);
  if (!config.passivity_controller) return algorithm;
  return std::make_unique<PassivityController>(std::move(algorithm), config);
}

}  // namespace hapbench
