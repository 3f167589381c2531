#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/module/hapbench_module.h"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_source.hpp"

/// Laws and sources of contacts behind the C interface. A step adds one indirect call and a check of the answer.
namespace hapbench {

/// A module's table and the file that it came from, without folders.
struct Module {
  std::shared_ptr<const HapbenchModule> table;
  std::string file;
};

/// The state of a module for one run. What the module throws is a fault like one that it reports. After a fault it is
/// not asked again until the next reset, and never when its state could not be made.
class ModuleState {
 public:
  explicit ModuleState(Module module) : module_(std::move(module)) {}
  ~ModuleState() { destroy(); }
  ModuleState(const ModuleState&) = delete;
  ModuleState& operator=(const ModuleState&) = delete;

  /// Makes the state anew; HapbenchRun::data is filled in. Returns false for a fault.
  bool create(const double* values, const char* config, HapbenchRun run) noexcept;
  void reset() noexcept;
  /// Returns false for a fault, this one's or an earlier one's.
  bool step(const HapbenchPose* pose, HapbenchContacts& contacts, HapbenchForce* force) noexcept;
  /// Makes a problem with the module's answer its fault, which names module and file.
  void fail(const char* problem) noexcept;
  /// The fault in one printable line; null for none.
  const char* fault() const noexcept { return fault_[0] == '\0' ? nullptr : fault_.data(); }

 private:
  void destroy() noexcept;
  /// Calls `call(fault)`, which runs the module's function of that name and returns whether it succeeded.
  template <class Call>
  bool runs(const char* function, const Call& call) noexcept;

  Module module_;
  void* state_ = nullptr;
  bool created_ = false;
  std::array<char, 320> fault_{};
};

/// A law of a module. It reads the contacts of the step in place and allocates nothing in a step.
class ModuleLaw final : public SingleSpringLaw {
 public:
  /// `values` are those of the module's parameters, in their order.
  ModuleLaw(Module module, double stiffness, std::vector<double> values)
      : SingleSpringLaw(stiffness), state_(std::move(module)), values_(std::move(values)) {}

  void prepare(std::size_t capacity) override;
  void reset() noexcept override;
  /// After a fault the force is NaN until the next reset.
  LawForce evaluate(ContactBuffer& contacts) noexcept override;
  const char* fault() const noexcept override { return state_.fault(); }

 private:
  LawForce failed(const char* problem) noexcept;

  ModuleState state_;
  std::vector<double> values_;
  std::vector<double> weights_;  ///< between numbers that find writes beyond them
};

/// The contacts of a module. It decides which there are, where, how deep and in which direction; no depth model takes
/// part. The normal is the reversed gradient. Unlike other sources, it allocates in a step if the module does.
class ModuleContacts final : public ContactSource {
 public:
  /// Throws std::runtime_error with the module's fault if it cannot make its state for this scenario's `config`, an
  /// object as JSON text.
  ModuleContacts(Module module, const std::string& config, const HapbenchRun& run);

  /// After a fault no contacts until the next reset. So are more than there is room for, what is not finite, a gradient
  /// whose length is not 1 within 0.001, and a negative depth.
  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }
  void reset() noexcept override;

 private:
  void take(std::size_t n, ContactBuffer& contacts) noexcept;

  ModuleState state_;
  std::size_t capacity_;
  double tool_length_;
};

/// The pose of a tool of HapbenchRun::tool_length [m] for a module.
HapbenchPose module_pose(const ToolPose& pose, double tool_length) noexcept;

/// The entry of the table for a module's law; `hash` is that of its file's content. Throws std::invalid_argument for a
/// module whose functions or documentation are missing.
AlgorithmEntry law_entry(Module module, std::string hash);

/// Faults of modules in runs, over all threads.
struct ModuleFaults {
  std::uint64_t count = 0;
  std::string first;  ///< text of the first
};
/// The faults since the last call.
ModuleFaults take_module_faults();

}  // namespace hapbench
