#pragma once

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/module/hapbench_module.h"

namespace hapbench {

/// Base class of a force law in a module. The functions have the meaning of the functions of the same names in
/// ForceLaw, the base class of the laws inside hapbench. Unlike the functions of ForceLaw, they may throw an exception,
/// which is a fault and ends the run. One instance holds the state of one run.
class ExternalForceLaw {
 public:
  explicit ExternalForceLaw(double stiffness) : K_(stiffness) {}
  virtual ~ExternalForceLaw() = default;
  /// Called before the first step; may allocate for up to `capacity` contacts.
  virtual void prepare(std::size_t capacity) { static_cast<void>(capacity); }
  /// Restores the state after `prepare`, bitwise.
  virtual void reset() {}
  /// Returns force and stiffness tensor. Writes the weights into the buffer; a change of any other number in the buffer
  /// is a fault. Preconditions: the buffer has at least one contact and is padded.
  virtual LawForce evaluate(ContactBuffer& contacts) = 0;
  /// If this function returns true, hapbench computes force and stiffness tensor from the weights. If it returns false,
  /// hapbench takes the result of `evaluate`.
  virtual bool gives_weights() const { return true; }

 protected:
  double K_;  ///< stiffness of one penalty spring [N/m]
};

/// Returns the module table for a class `Law` that is derived from ExternalForceLaw and has the constructor `Law(double
/// stiffness, const double* values)`; `values` are the values of its parameters. `info.parameters` is not used. An
/// exception of the law is a fault, which ends the run. As in version 0.3, a law may also be derived
/// from ForceLaw, in which evaluate, reset and gives_weights are noexcept: an exception of these functions ends the
/// program.
///
/// The module contains its own copy of hapbench's code and copies the contacts. It may therefore be built with
/// another compiler, or for another instruction set, than the program that loads it.
template <class Law>
HapbenchModule law_module(const ModelInfo& info, std::span<const HapbenchParameter> parameters = {}) {
  static_assert(std::is_base_of_v<ExternalForceLaw, Law> || std::is_base_of_v<ForceLaw, Law>,
                "derive the law from hapbench::ExternalForceLaw");
  static_assert(std::is_base_of_v<ForceLaw, Law> ||
                    (!noexcept(std::declval<Law&>().evaluate(std::declval<ContactBuffer&>())) &&
                     !noexcept(std::declval<Law&>().prepare(0)) && !noexcept(std::declval<Law&>().reset())),
                "remove noexcept from the functions of the law: an exception of a noexcept function would end the "
                "program");
  struct State {
    Law law;
    ContactBuffer contacts;

    int step(HapbenchContacts& given, HapbenchForce& answer, char* fault) {
      // Copy the contacts into a buffer.
      std::copy_n(given.index, given.n, contacts.index.begin());
      struct Column {
        const char* name;
        const double* from;
        AlignedDoubles& to;
      };
      const Column columns[] = {{"depth", given.depth, contacts.depth},
                                {"ux", given.gx, contacts.ux},
                                {"uy", given.gy, contacts.uy},
                                {"uz", given.gz, contacts.uz},
                                {"x", given.x, contacts.x},
                                {"y", given.y, contacts.y},
                                {"z", given.z, contacts.z},
                                {"nx", given.nx, contacts.nx},
                                {"ny", given.ny, contacts.ny},
                                {"nz", given.nz, contacts.nz}};
      for (const auto& [name, from, to] : columns) std::copy_n(from, given.n, to.begin());
      contacts.clear();
      contacts.extend(given.n);
      contacts.pad();
      const auto [f, S] = law.evaluate(contacts);
      // Check that the law has written the weights only. hapbench computes the force from its own contacts, so that any
      // other change would have no effect.
      const auto changed = [&](const char* name) {
        std::snprintf(fault, HAPBENCH_FAULT_SIZE, "it changes the contacts (%s); allowed: writing the weights", name);
        return 1;
      };
      if (contacts.size() != given.n) return changed("their number");
      if (!std::equal(given.index, given.index + given.n, contacts.index.begin())) return changed("index");
      for (const auto& [name, from, to] : columns)
        if (std::memcmp(from, to.data(), given.n * sizeof(double)) != 0) return changed(name);
      std::copy_n(contacts.weight.begin(), given.n, given.weight);
      answer = {!law.gives_weights(), {f.x(), f.y(), f.z()}, {S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2)}};
      return 0;
    }
  };
  HapbenchModule module = {};
  module.version = HAPBENCH_MODULE_VERSION;
  module.kind = HAPBENCH_LAW;
  module.name = info.name;
  module.summary = info.summary;
  module.formula = info.formula;
  module.source = info.source;
  module.known_failure = info.known_failure;
  module.parameters = parameters.data();
  module.parameter_count = parameters.size();
  module.create = [](const double* values, const char*, const HapbenchRun* run, char*) -> void* {
    std::unique_ptr<State> state(new State{Law(run->stiffness, values), ContactBuffer(run->capacity)});
    state->law.prepare(run->capacity);
    return state.release();
  };
  module.step = [](void* state, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce* force, char* fault) {
    return static_cast<State*>(state)->step(*contacts, *force, fault);
  };
  module.reset = [](void* state) { static_cast<State*>(state)->law.reset(); };
  module.destroy = [](void* state) { delete static_cast<State*>(state); };
  return module;
}

}  // namespace hapbench
