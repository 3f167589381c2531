#include "algorithms/module/module.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMaxParameters = 1000;

/// kGuards: number of guard values on each side of a law's weights. kUnwritten: the value of guards, and of weights
/// that the law has not written. No computation produces this signalling NaN.
constexpr std::size_t kGuards = 8;
constexpr auto kUnwritten = std::uint64_t{0x7ff4deadc0ffee00};

constexpr double kLengthTolerance = 1e-3;  ///< largest allowed difference between a gradient's length and 1

/// The faults since the last take_module_faults(). A fault may happen in a haptic loop, so recording a fault neither
/// locks nor allocates. Only the text of the first fault is kept.
std::atomic<std::uint64_t> fault_count = 0;
std::atomic<bool> text_is_claimed = false, text_is_written = false;
std::array<char, kFaultTextSize> first_fault{};

void count_fault(const std::array<char, kFaultTextSize>& text) noexcept {
  if (!text_is_claimed.exchange(true)) {
    first_fault = text;
    text_is_written.store(true, std::memory_order_release);
  }
  ++fault_count;
}

/// Returns the buffer's arrays in the form that a module reads and writes.
HapbenchContacts view_of(ContactBuffer& c) {
  return {.n = c.size(),
          .room = c.capacity(),
          .index = c.index.data(),
          .depth = c.depth.data(),
          .gx = c.ux.data(),
          .gy = c.uy.data(),
          .gz = c.uz.data(),
          .x = c.x.data(),
          .y = c.y.data(),
          .z = c.z.data(),
          .nx = nullptr,
          .ny = nullptr,
          .nz = nullptr,
          .weight = nullptr};
}

/// Name (of the member of HapbenchContacts) and source of an array of numbers that a law may read but not write.
struct InputArray {
  const char* name;
  AlignedDoubles ContactBuffer::*source;
};
constexpr InputArray kInputArrays[] = {{"depth", &ContactBuffer::depth}, {"gx", &ContactBuffer::ux},
                                       {"gy", &ContactBuffer::uy},       {"gz", &ContactBuffer::uz},
                                       {"x", &ContactBuffer::x},         {"y", &ContactBuffer::y},
                                       {"z", &ContactBuffer::z},         {"nx", &ContactBuffer::nx},
                                       {"ny", &ContactBuffer::ny},       {"nz", &ContactBuffer::nz}};

LawForce force_of(const HapbenchForce& answer) {
  const auto& [xx, xy, xz, yy, yz, zz] = answer.stiffness;
  LawForce force{{answer.force[0], answer.force[1], answer.force[2]}, {}};
  force.S << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return force;
}

/// Returns the result of a law that has failed: a force of NaN and a tensor of zero.
LawForce no_force() {
  return {Vec3::Constant(kNaN), Mat3::Zero()};
}

/// Returns the problem of contact i from a module; null if the contact is valid.
const char* problem_of(const ContactBuffer& contacts, std::size_t i) {
  const Vec3 gradient = contacts.gradient(i);
  if (!contacts.point(i).allFinite() || !gradient.allFinite() || !std::isfinite(contacts.depth[i]))
    return "gives a contact that is not finite";
  if (std::abs(gradient.norm() - 1.0) > kLengthTolerance) return "gives a contact whose gradient is not a unit vector";
  return contacts.depth[i] < 0.0 ? "gives a contact with a negative depth" : nullptr;
}

}  // namespace

template <class Call>
bool ModuleState::call_guarded(const char* function, const Call& call) noexcept {
  std::array<char, HAPBENCH_FAULT_SIZE> text;
  std::array<char, HAPBENCH_FAULT_SIZE + 64> problem;
  text.front() = text.back() = '\0';
  try {
    if (call(text.data()) && text[0] == '\0') return true;
    text.back() = '\0';
    std::snprintf(problem.data(), problem.size(), "fails in %s: %s", function,
                  text[0] == '\0' ? "no reason given" : text.data());
  } catch (const std::exception& thrown) {
    std::snprintf(problem.data(), problem.size(), "throws in %s: %s", function, thrown.what());
  } catch (...) {
    std::snprintf(problem.data(), problem.size(), "throws in %s", function);
  }
  fail(problem.data());
  return false;
}

void ModuleState::fail(const char* problem) noexcept {
  std::snprintf(fault_.data(), fault_.size(), "%s (%s) %s", module_.table->name, module_.file.c_str(), problem);
  // Replace control characters, because the text is printed in one line and written as JSON.
  for (char& c : fault_) c = c == '\0' || (c >= ' ' && c <= '~') ? c : '?';
  count_fault(fault_);
}

bool ModuleState::create(const double* values, const char* config, HapbenchRun run) noexcept {
  destroy();
  fault_[0] = '\0';
  run.data = module_.table->data;
  const auto create = module_.table->create;
  created_ = create == nullptr || call_guarded("create", [&](char* fault) {
               state_ = create(values, config, &run, fault);
               return state_ != nullptr;
             });
  return created_;
}

void ModuleState::destroy() noexcept {
  const auto destroy = module_.table->destroy;
  if (state_ != nullptr && destroy != nullptr) {
    call_guarded("destroy", [&](char*) {
      destroy(state_);
      return true;
    });
  }
  state_ = nullptr;
  created_ = false;
}

void ModuleState::reset() noexcept {
  if (!created_) return;  // the fault of `create` stays
  fault_[0] = '\0';
  const auto reset = module_.table->reset;
  if (reset == nullptr) return;
  call_guarded("reset", [&](char*) {
    reset(state_);
    return true;
  });
}

bool ModuleState::step(const HapbenchPose* pose, HapbenchContacts& contacts, HapbenchForce* force) noexcept {
  if (fault() != nullptr) return false;
  return call_guarded("step",
                      [&](char* text) { return module_.table->step(state_, pose, &contacts, force, text) == 0; });
}

void ModuleLaw::prepare(std::size_t capacity) {
  numbers_.resize(3 * kGuards + capacity * (1 + std::size(kInputArrays)));
  indices_.resize(capacity);
  HapbenchRun run = {};
  run.stiffness = K_;
  run.capacity = capacity;
  state_.create(values_.data(), "{}", run);
}

void ModuleLaw::reset() noexcept {
  ForceLaw::reset();
  state_.reset();
}

LawForce ModuleLaw::failed(const char* problem) noexcept {
  state_.fail(problem);
  return no_force();
}

HapbenchContacts ModuleLaw::copies_of(const ContactBuffer& contacts) noexcept {
  const std::size_t n = contacts.size();
  double* const weights = numbers_.data() + kGuards;
  double* next = std::fill_n(numbers_.data(), n + 2 * kGuards, std::bit_cast<double>(kUnwritten));
  double* copies[std::size(kInputArrays)];
  for (std::size_t i = 0; i < std::size(kInputArrays); ++i) {
    copies[i] = next;
    next = std::copy_n((contacts.*kInputArrays[i].source).data(), n, next);
  }
  std::copy_n(contacts.index.data(), n, indices_.data());
  const auto& [depth, gx, gy, gz, x, y, z, nx, ny, nz] = copies;
  return {.n = n,
          .room = n,
          .index = indices_.data(),
          .depth = depth,
          .gx = gx,
          .gy = gy,
          .gz = gz,
          .x = x,
          .y = y,
          .z = z,
          .nx = nx,
          .ny = ny,
          .nz = nz,
          .weight = weights};
}

const char* ModuleLaw::changed_field(const HapbenchContacts& given, const ContactBuffer& contacts) const noexcept {
  const std::size_t n = contacts.size();
  if (given.n != n) return "n";
  if (!std::equal(contacts.index.data(), contacts.index.data() + n, indices_.data())) return "index";
  const double* copy = numbers_.data() + n + 2 * kGuards;
  for (const auto& [name, source] : kInputArrays) {
    if (std::memcmp((contacts.*source).data(), copy, n * sizeof(double)) != 0) return name;
    copy += n;
  }
  return nullptr;
}

LawForce ModuleLaw::evaluate(ContactBuffer& contacts) noexcept {
  if (contacts.empty()) return {};
  // Call the module with copies of the contacts.
  set_weights(contacts, 0.0);
  HapbenchContacts given = copies_of(contacts);
  HapbenchForce answer = {0, {kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}};
  if (!state_.step(nullptr, given, &answer)) return no_force();
  // Check that the module has written the weights only.
  const std::size_t n = contacts.size();
  double* const weights = numbers_.data() + kGuards;
  double* const end = weights + n;
  const auto is_unwritten = [](double number) { return std::bit_cast<std::uint64_t>(number) == kUnwritten; };
  if (!std::all_of(weights - kGuards, weights, is_unwritten) || !std::all_of(end, end + kGuards, is_unwritten))
    return failed("writes beyond its weights, of which there is one for each contact");
  if (const char* field = changed_field(given, contacts)) {
    std::array<char, 160> problem;
    std::snprintf(problem.data(), problem.size(),
                  "changes the contacts (%s); allowed: writing the weights, or force and stiffness (HapbenchForce)",
                  field);
    return failed(problem.data());
  }
  // Compute the force from the weights, or take the force of the module. A module that gives a force may leave weights
  // unwritten; each unwritten weight becomes 1 / n.
  gives_weights_ = answer.given == 0;
  if (!gives_weights_) std::replace_if(weights, end, is_unwritten, 1.0 / static_cast<double>(n));
  std::copy(weights, end, contacts.weight.begin());
  LawForce force = gives_weights_ ? weighted_force(contacts, K_) : force_of(answer);
  // A weight that is not finite also makes the tensor not finite.
  if (!force.spring.allFinite()) return failed("gives a force that is not finite");
  if (!force.S.allFinite()) return failed("gives a stiffness that is not finite");
  return force;
}

ModuleContacts::ModuleContacts(Module module, const std::string& config, const HapbenchRun& run)
    : state_(std::move(module)), capacity_(run.capacity), tool_length_(run.tool_length) {
  if (!state_.create(nullptr, config.c_str(), run)) throw std::runtime_error(state_.fault());
}

void ModuleContacts::reset() noexcept {
  work_ = {};
  state_.reset();
  fault_ = state_.fault();
}

void ModuleContacts::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  HapbenchContacts view = view_of(contacts);
  view.room = capacity_;
  const HapbenchPose at = module_pose(pose, tool_length_);
  if (state_.step(&at, view, nullptr)) accept(view.n, contacts);
  fault_ = state_.fault();
  contacts.pad();
}

void ModuleContacts::accept(std::size_t n, ContactBuffer& contacts) noexcept {
  if (n > capacity_) {
    std::array<char, 80> problem;
    std::snprintf(problem.data(), problem.size(), "gives %zu contacts; allowed: at most %zu", n, capacity_);
    return state_.fail(problem.data());
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (const char* problem = problem_of(contacts, i)) return state_.fail(problem);
    const Vec3 gradient = contacts.gradient(i), unit = gradient / gradient.norm();
    contacts.set_gradient(i, unit);
    contacts.nx[i] = -unit.x();
    contacts.ny[i] = -unit.y();
    contacts.nz[i] = -unit.z();
    contacts.weight[i] = 0.0;
  }
  contacts.extend(n);
}

HapbenchPose module_pose(const ToolPose& pose, double tool_length) noexcept {
  const Vec3 centre = pose.position - 0.5 * tool_length * pose.axis;
  const Mat3 r = pose.rotation();
  const Vec3& tip = pose.position;
  return {.tip = {tip.x(), tip.y(), tip.z()},
          .centre = {centre.x(), centre.y(), centre.z()},
          .rotation = {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}};
}

AlgorithmEntry law_entry(Module module, std::string hash) {
  const HapbenchModule& table = *module.table;
  if (table.step == nullptr) refuse("its function \"step\" is missing");
  if (table.parameter_count > kMaxParameters)
    refuse("it has ", table.parameter_count, " parameters; allowed: at most ", kMaxParameters);
  if (table.parameter_count > 0 && table.parameters == nullptr) refuse("its table of parameters is missing");
  const ModelInfo info = {.name = table.name,
                          .summary = table.summary,
                          .formula = table.formula,
                          .source = table.source,
                          .known_failure = table.known_failure,
                          .parameters = kStiffnessAlone};
  std::vector<AlgorithmParameter> parameters;
  for (std::size_t i = 0; i < table.parameter_count; ++i) {
    const HapbenchParameter& p = table.parameters[i];
    parameters.push_back({.name = p.name, .range = {p.min, p.max, p.unit}, .initial = p.initial, .meaning = p.meaning});
  }
  const std::string file = module.file;
  const auto make_law = [module = std::move(module)](const RenderingConfig& config) {
    return std::make_unique<ModuleLaw>(module, config.stiffness,
                                       parameter_values(config, *find_algorithm(module.table->name)));
  };
  return checked_copy(
      {.info = &info, .make_law = make_law, .algorithm_parameters = parameters, .origin = {file, std::move(hash)}});
}

ModuleFaults take_module_faults() {
  ModuleFaults faults = {fault_count.exchange(0), ""};
  if (text_is_written.load(std::memory_order_acquire)) {
    faults.first = first_fault.data();
    text_is_written = false;
    text_is_claimed = false;
  }
  return faults;
}

}  // namespace hapbench
