#include "algorithms/plugin/plugin_law.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "algorithms/plugin/plugin_call.hpp"

namespace hapbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostParameters = 1000;

/// The force of a law that has failed.
LawForce no_force() {
  return {Vec3::Constant(kNaN), Mat3::Zero()};
}

constexpr HapbenchForce kUnwritten = {{kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}};

HapbenchContacts view_of(const ContactBuffer& c) {
  return {.n = c.size(),
          .depth = c.depth.data(),
          .gx = c.ux.data(),
          .gy = c.uy.data(),
          .gz = c.uz.data(),
          .x = c.x.data(),
          .y = c.y.data(),
          .z = c.z.data(),
          .nx = c.nx.data(),
          .ny = c.ny.data(),
          .nz = c.nz.data(),
          .index = c.index.data()};
}

LawForce force_of(const HapbenchForce& answer) {
  const auto& [xx, xy, xz, yy, yz, zz] = answer.stiffness;
  LawForce force{{answer.force[0], answer.force[1], answer.force[2]}, {}};
  force.S << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return force;
}

std::mutex faults_mutex;
PluginFaults& faults() {
  static PluginFaults all;
  return all;
}

/// May allocate, because the run is over.
void note_fault(const char* text) {
  const std::lock_guard lock(faults_mutex);
  if (faults().count++ == 0) faults().first = text;
}

}  // namespace

PluginLaw::PluginLaw(const HapbenchPlugin& plugin, double stiffness, std::vector<double> parameters)
    : SingleSpringLaw(stiffness), plugin_(plugin), parameters_(std::move(parameters)) {
  gives_weights_ = plugin.gives == HAPBENCH_WEIGHTS;
}

PluginLaw::~PluginLaw() {
  destroy();
}

void PluginLaw::destroy() noexcept {
  if (law_ != nullptr && plugin_.destroy != nullptr) runs("destroy", [this] { plugin_.destroy(law_); });
  law_ = nullptr;
}

void PluginLaw::prepare(std::size_t capacity) {
  destroy();
  guarded_weights_.resize(capacity + 2 * Canaries::kCount);
  runs("create", [this, capacity] { law_ = plugin_.create(parameters_.data(), K_, capacity); });
}

void PluginLaw::reset() noexcept {
  ForceLaw::reset();
  fault_[0] = '\0';
  if (law_ != nullptr && plugin_.reset != nullptr) runs("reset", [this] { plugin_.reset(law_); });
}

template <class Call>
bool PluginLaw::runs(const char* function, const Call& call) const noexcept {
  std::array<char, 200> problem{};
  try {
    const PluginCall running(plugin_.name, function);
    call();
    return true;
  } catch (const std::exception& thrown) {
    std::snprintf(problem.data(), problem.size(), "throws in %s: %s", function, thrown.what());
  } catch (...) {
    std::snprintf(problem.data(), problem.size(), "throws in %s", function);
  }
  failed(problem.data());
  return false;
}

LawForce PluginLaw::failed(const char* problem) const noexcept {
  std::snprintf(fault_.data(), fault_.size(), "%s %s", plugin_.name, problem);
  // The text is printed in one line and written as JSON, whatever the plugin answers.
  for (char& c : fault_) c = c == '\0' || (c >= ' ' && c <= '~') ? c : '?';
  note_fault(fault_.data());
  return no_force();
}

LawForce PluginLaw::failed(int error) noexcept {
  const char* text = nullptr;
  if (plugin_.error_text != nullptr && !runs("error_text", [&] { text = plugin_.error_text(law_, error); }))
    return no_force();
  std::array<char, 200> problem{};
  std::snprintf(problem.data(), problem.size(), "reports error %d%s%s", error, text != nullptr ? ": " : "",
                text != nullptr ? text : "");
  return failed(problem.data());
}

LawForce PluginLaw::evaluate(ContactBuffer& contacts) noexcept {
  if (contacts.empty()) return {};
  if (fault() != nullptr) return no_force();
  if (law_ == nullptr) return failed("could not be created with these parameters");
  const std::size_t n = contacts.size();
  double* weights = guarded_weights_.data() + Canaries::kCount;
  kCanaries.write(weights - Canaries::kCount);
  kCanaries.write(weights + n);
  // Pre-fills with NaN to detect outputs that the plugin did not write.
  std::fill_n(weights, n, gives_weights_ ? kNaN : 1.0 / static_cast<double>(n));
  Guarded<HapbenchForce> guarded{{}, kUnwritten, {}};
  const HapbenchContacts view = view_of(contacts);
  int error = 0;
  if (!runs("evaluate", [&] { error = plugin_.evaluate(law_, &view, weights, &guarded.answer); })) return no_force();
  if (error != 0) return failed(error);
  if (!kCanaries.are_at(weights - Canaries::kCount) || !kCanaries.are_at(weights + n))
    return failed("writes beyond its weights, of which there is one for each contact");
  if (!guarded.intact()) return failed("writes beyond its answer");
  set_weights(contacts, 0.0);
  std::copy_n(weights, n, contacts.weight.begin());
  const LawForce force = gives_weights_ ? weighted_force(contacts, K_) : force_of(guarded.answer);
  // A weight that is not finite makes the tensor not finite, too.
  if (!force.spring.allFinite()) return failed("gives a force that is not finite");
  if (!force.S.allFinite()) return failed("gives a stiffness that is not finite");
  return force;
}

SpringState PluginLaw::spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept {
  if (fault() != nullptr) return {};
  if (plugin_.springs != nullptr) {
    SpringState state;
    const HapbenchContacts view = view_of(contacts);
    if (!runs("springs", [&] { plugin_.springs(law_, &view, tip.data(), &state.energy, state.moment.data()); }))
      state.energy = kNaN;
    return state;
  }
  return SingleSpringLaw::spring_state(contacts, spring, tip);
}

AlgorithmEntry plugin_entry(const HapbenchPlugin& plugin, AlgorithmOrigin origin) {
  if (plugin.create == nullptr) throw std::invalid_argument("its function \"create\" is missing");
  if (plugin.evaluate == nullptr) throw std::invalid_argument("its function \"evaluate\" is missing");
  if (plugin.gives != HAPBENCH_WEIGHTS && plugin.gives != HAPBENCH_FORCE)
    throw std::invalid_argument("\"gives\" is " + std::to_string(plugin.gives) +
                                "; allowed: HAPBENCH_WEIGHTS or HAPBENCH_FORCE");
  if (plugin.parameter_count > kMostParameters)
    throw std::invalid_argument("it has " + std::to_string(plugin.parameter_count) + " parameters; allowed: at most " +
                                std::to_string(kMostParameters));
  if (plugin.parameter_count > 0 && plugin.parameters == nullptr)
    throw std::invalid_argument("its table of parameters is missing");
  const ModelInfo info = {.name = plugin.name,
                          .summary = plugin.summary,
                          .formula = plugin.formula,
                          .source = plugin.source,
                          .known_failure = plugin.known_failure,
                          .parameters = kStiffnessAlone};
  std::vector<OwnParameter> parameters;
  for (std::size_t i = 0; i < plugin.parameter_count; ++i) {
    const HapbenchParameter& p = plugin.parameters[i];
    parameters.push_back({.name = p.name, .range = {p.min, p.max, p.unit}, .initial = p.initial, .meaning = p.meaning});
  }
  const auto make_law = [&plugin](const RenderingConfig& config) {
    return std::make_unique<PluginLaw>(plugin, config.stiffness, own_values(config, *find_algorithm(plugin.name)));
  };
  return checked_copy({.info = &info, .make_law = make_law, .own_parameters = parameters, .origin = std::move(origin)});
}

PluginFaults take_plugin_faults() {
  const std::lock_guard lock(faults_mutex);
  return std::exchange(faults(), {});
}

}  // namespace hapbench
