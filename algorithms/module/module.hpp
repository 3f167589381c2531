#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/module/hapbench_module.h"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_source.hpp"

/// Runs force laws and contact sources that external modules implement through the C interface (hapbench_module.h).
/// Compared with built-in code, a step costs one more indirect call and a check of the result; a law also receives a
/// copy of the contacts.
namespace hapbench {

/// A loaded module: its table of functions and texts, and the name of its file without folders.
struct Module {
  std::shared_ptr<const HapbenchModule> table;
  std::string file;
};

/// Size [characters] of the buffer for the text of a fault, which includes the names of module and file. Longer text is
/// cut.
inline constexpr std::size_t kFaultTextSize = 320;

/// The state of a module in one run. An exception counts as a fault, like a fault that the module reports. After a
/// fault, the module is not called again until the next reset. If the module could not create its state, it is not
/// called again, even after a reset.
class ModuleState {
 public:
  explicit ModuleState(Module module) : module_(std::move(module)) {}
  ~ModuleState() { destroy(); }
  ModuleState(const ModuleState&) = delete;
  ModuleState& operator=(const ModuleState&) = delete;

  /// Creates a new state for `run`, after setting HapbenchRun::data from the module's table. Returns false if the
  /// module cannot create the state, which counts as a fault.
  bool create(const double* values, const char* config, HapbenchRun run) noexcept;
  /// Resets the state to t = 0 and clears the fault. Does nothing if the state could not be created.
  void reset() noexcept;
  /// Evaluates one step. Returns false if a fault has happened in this step or, since the last reset, in an earlier
  /// step.
  bool step(const HapbenchPose* pose, HapbenchContacts& contacts, HapbenchForce* force) noexcept;
  /// Records `problem`, a problem with the result of the module, as a fault. The text of the fault begins with the
  /// names of module and file.
  void fail(const char* problem) noexcept;
  /// Returns the fault as one printable line, or null.
  const char* fault() const noexcept { return fault_[0] == '\0' ? nullptr : fault_.data(); }

 private:
  void destroy() noexcept;
  /// Returns true if `call(text)` returns true and writes no text. `call` calls a function of the module, which may
  /// write the reason of a failure into the buffer `text`. If `call` returns false, writes a text or throws, records a
  /// fault that names `function`, and returns false.
  template <class Call>
  bool call_guarded(const char* function, const Call& call) noexcept;

  Module module_;
  void* state_ = nullptr;
  bool created_ = false;
  std::array<char, kFaultTextSize> fault_{};
};

/// A force law from a module. The module receives copies of the contacts, so that it cannot change the contacts that
/// the run records. Allocates nothing in a step.
class ModuleLaw final : public SingleSpringLaw {
 public:
  /// `values` are the values of the module's parameters, in their order.
  ModuleLaw(Module module, double stiffness, std::vector<double> values)
      : SingleSpringLaw(stiffness), state_(std::move(module)), values_(std::move(values)) {}

  void prepare(std::size_t capacity) override;
  void reset() noexcept override;
  /// After a fault the force is NaN until the next reset.
  LawForce evaluate(ContactBuffer& contacts) noexcept override;
  const char* fault() const noexcept override { return state_.fault(); }

 private:
  /// Returns the arrays that the module reads and writes, for one call: copies of the contacts in numbers_ and
  /// indices_, and unwritten weights.
  HapbenchContacts copies_of(const ContactBuffer& contacts) noexcept;
  /// Returns the name of the first field of `given` that the module has changed and that is not the weights; null if
  /// there is no such field. `given`: the arrays of the call. `contacts`: the contacts from which they were copied.
  const char* changed_field(const HapbenchContacts& given, const ContactBuffer& contacts) const noexcept;
  LawForce failed(const char* problem) noexcept;

  ModuleState state_;
  std::vector<double> values_;
  /// Memory of the arrays of one call: guard values, weights, guard values, then the copies of the other arrays of
  /// numbers without gaps, and an unused gap behind them. A changed guard value shows that the module wrote out of
  /// range.
  std::vector<double> numbers_;
  std::vector<std::uint32_t> indices_;
};

/// Contacts from a module, which determines their number, positions, depths and gradients. No depth model is used. The
/// normal is the reversed gradient. If the module allocates in a step, this source allocates in the step; other sources
/// never do.
class ModuleContacts final : public ContactSource {
 public:
  /// Throws std::runtime_error with the module's fault if the module cannot create its state. `config` is the
  /// scenario's JSON object as text.
  ModuleContacts(Module module, const std::string& config, const HapbenchRun& run);

  /// Returns no contacts after a fault, until the next reset. Each of these results counts as a fault: more contacts
  /// than capacity(), a value that is not finite, a gradient whose length differs from 1 by more than 0.001, or a
  /// negative depth.
  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }
  void reset() noexcept override;

 private:
  void accept(std::size_t n, ContactBuffer& contacts) noexcept;

  ModuleState state_;
  std::size_t capacity_;
  double tool_length_;
};

/// Returns the pose in the form that modules receive, for a tool with HapbenchRun::tool_length [m].
HapbenchPose module_pose(const ToolPose& pose, double tool_length) noexcept;

/// Returns the entry of the algorithm table for a module's law. `hash`: hash of the content of the module's file.
/// Throws std::invalid_argument if functions or documentation of the module are missing.
AlgorithmEntry law_entry(Module module, std::string hash);

/// Faults of modules in runs, collected over all threads.
struct ModuleFaults {
  std::uint64_t count = 0;
  std::string first;  ///< text of the first fault
};
/// Returns the faults since the last call. Precondition: no other thread calls a module at the same time.
ModuleFaults take_module_faults();

}  // namespace hapbench
