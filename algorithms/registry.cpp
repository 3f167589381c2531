#include "algorithms/registry.hpp"

#include <cmath>
#include <set>

#include "algorithms/penalty_rendering.hpp"
#include "algorithms/stages/controllers.hpp"
#include "sim/tool/refuse.hpp"

/// The built-in algorithms, in the order in which they are listed. For each name, a source file in laws/ or proxy/
/// defines `AlgorithmEntry <name>_entry()`.
#define HAPBENCH_ALGORITHMS(entry)                                                                       \
  entry(original_averaging) entry(summation) entry(mean) entry(virtual_coupling) entry(shaped_stiffness) \
      entry(tandpasta) entry(normal_projection) entry(exact_shaping) entry(continuous_normal_projection) \
          entry(merged_shaping) entry(proxy) entry(least_squares) entry(highest_depth) entry(mcneely)    \
              entry(static_coupling)

namespace hapbench {

#define HAPBENCH_DECLARE(name) AlgorithmEntry name##_entry();
HAPBENCH_ALGORITHMS(HAPBENCH_DECLARE)
#undef HAPBENCH_DECLARE

namespace {

/// The algorithm table. It is built at its first use, because initialisers of static variables in other files may
/// already use the table.
struct Table {
#define HAPBENCH_ENTRY(name) name##_entry(),
  std::deque<AlgorithmEntry> entries = {HAPBENCH_ALGORITHMS(HAPBENCH_ENTRY)};
#undef HAPBENCH_ENTRY
  std::size_t built_in_size = entries.size();
  std::size_t additions = 0;
};

Table& table() {
  static Table instance;
  return instance;
}

constexpr const ModelInfo* kStages[] = {&kLocalAverageInfo, &kGradientReductionInfo,        &kDampingAndLimitsInfo,
                                        &kEnergyTankInfo,   &kActuatorLimitedPassivityInfo, &kPassivityControllerInfo};

const AlgorithmEntry& algorithm_entry(std::string_view name) {
  if (const AlgorithmEntry* entry = find_algorithm(name)) return *entry;
  refuse("unknown algorithm ", name);
}

/// Throws std::invalid_argument if `text` is not allowed as a name. Allowed names can be used both as a scenario field
/// and as an entry of a list on the command line.
void require_name(const std::string& what, const char* text) {
  const std::string_view name = text == nullptr ? "" : text;
  constexpr std::size_t kLongest = 64;
  const bool is_name = !name.empty() && name.size() <= kLongest && name[0] >= 'a' && name[0] <= 'z';
  if (!is_name ||
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") != name.npos)
    refuse(what, R"( is called ")", name, R"("; allowed: letters, digits and "_", a small letter first, at most 64)");
}

void require_text(const char* text, const std::string& what) {
  if (text == nullptr || *text == '\0') refuse(what, " is missing");
}

void check(const AlgorithmParameter& p) {
  require_name("a parameter", p.name);
  const std::string which = "parameter \"" + std::string(p.name) + "\": ";
  require_text(p.range.unit, which + "its unit");
  require_text(p.meaning, which + "its meaning");
  const auto& [min, max, unit, above_min] = p.range;
  if (!(std::isfinite(min) && std::isfinite(max) && min < max))
    refuse(which, "a range needs two finite limits, the lower limit first");
  if (!(p.initial <= max && (above_min ? p.initial > min : p.initial >= min)))
    refuse(which, "its default is out of its range");
}

/// Throws std::invalid_argument if a name, a text or a parameter of the entry is invalid.
void check(const AlgorithmEntry& entry) {
  const ModelInfo& info = *entry.info;
  require_name("an algorithm", info.name);
  // `--algorithms all` selects all algorithms.
  if (info.name == std::string_view("all")) refuse("an algorithm is called \"all\", which means all of them");
  for (const auto& [what, text] :
       {std::pair{"its summary", info.summary}, std::pair{"its formula", info.formula},
        std::pair{"its source", info.source}, std::pair{"its known failure", info.known_failure}}) {
    require_text(text, what);
  }
  std::set<std::string_view> seen;
  for (const AlgorithmParameter& p : entry.algorithm_parameters) {
    check(p);
    if (!seen.insert(p.name).second) refuse("parameter \"", p.name, "\" occurs twice");
  }
}

std::unique_ptr<ForceStage> make_force_stage(const ForceStageConfig& config) {
  if (const auto* tank = std::get_if<EnergyTankConfig>(&config)) return std::make_unique<EnergyTank>(*tank);
  return std::make_unique<ActuatorLimitedPassivity>(std::get<ActuatorLimitedPassivityConfig>(config));
}

/// Owner of the texts to which `info` and `algorithm_parameters` of an external algorithm point.
struct Texts {
  std::deque<std::string> all;
  ModelInfo info = {};
  std::vector<AlgorithmParameter> parameters;

  const char* copy(const char* text) { return all.emplace_back(text).c_str(); }
};

}  // namespace

double parameter_value(const RenderingConfig& config, const char* algorithm, const AlgorithmParameter& parameter) {
  const auto values = config.parameters.find(algorithm);
  if (values == config.parameters.end()) return parameter.initial;
  const auto value = values->second.find(parameter.name);
  return value == values->second.end() ? parameter.initial : value->second;
}

const std::deque<AlgorithmEntry>& algorithms() {
  return table().entries;
}

std::vector<std::string> algorithm_names() {
  std::vector<std::string> names;
  for (const AlgorithmEntry& entry : table().entries) names.emplace_back(entry.info->name);
  return names;
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
  // Copy the texts of the parameters, then the texts of the documentation.
  for (AlgorithmParameter p : entry.algorithm_parameters) {
    for (const char** text : {&p.name, &p.range.unit, &p.meaning}) *text = t.copy(*text);
    t.parameters.push_back(p);
  }
  t.info = *entry.info;
  for (const char** text : {&t.info.name, &t.info.summary, &t.info.formula, &t.info.source, &t.info.known_failure})
    *text = t.copy(*text);
  entry.info = &t.info;
  entry.algorithm_parameters = t.parameters;
  entry.texts = std::move(texts);
  return entry;
}

void add_algorithm(AlgorithmEntry entry) {
  entry = checked_copy(std::move(entry));
  const std::vector<std::string> names = algorithm_names();
  const auto same = std::find(names.begin(), names.end(), entry.info->name);
  const auto index = static_cast<std::size_t>(same - names.begin());
  auto& [entries, built_in_size, count] = table();
  if (index < built_in_size) refuse("\"", *same, "\" is the name of a built-in algorithm");
  ++count;
  if (index == entries.size()) {
    entries.push_back(std::move(entry));
  } else {
    entries[index] = std::move(entry);
  }
}

std::size_t additions() {
  return table().additions;
}

std::vector<double> parameter_values(const RenderingConfig& config, const AlgorithmEntry& entry) {
  std::vector<double> values;
  for (const AlgorithmParameter& p : entry.algorithm_parameters)
    values.push_back(parameter_value(config, entry.info->name, p));
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
  if (!entry.make_law) refuse(name, " is not a force law");
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
