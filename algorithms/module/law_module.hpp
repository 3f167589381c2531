#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/module/hapbench_module.h"

namespace hapbench {

/// The table of a module for a class that is derived from ForceLaw and made from K and the values of its own
/// parameters, `Law(double stiffness, const double* values)`; `info.parameters` is not used. The module has its own
/// copy of hapbench's code and of the contacts, so it need not be built by the compiler, or for the instruction set, of
/// the program that loads it. Of the class's overrides only those of `evaluate`, `prepare`, `reset` and `gives_weights`
/// take part. What the class throws ends the run.
template <class Law>
HapbenchModule law_module(const ModelInfo& info, std::span<const HapbenchParameter> parameters = {}) {
  struct State {
    Law law;
    ContactBuffer contacts;

    int step(HapbenchContacts& given, HapbenchForce& answer) {
      const auto copy = [n = given.n](const auto* from, auto& to) { std::copy_n(from, n, to.begin()); };
      copy(given.index, contacts.index);
      copy(given.depth, contacts.depth);
      copy(given.gx, contacts.ux);
      copy(given.gy, contacts.uy);
      copy(given.gz, contacts.uz);
      copy(given.x, contacts.x);
      copy(given.y, contacts.y);
      copy(given.z, contacts.z);
      copy(given.nx, contacts.nx);
      copy(given.ny, contacts.ny);
      copy(given.nz, contacts.nz);
      contacts.clear();
      contacts.extend(given.n);
      contacts.pad();
      const auto [f, S] = law.evaluate(contacts);
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
  module.step = [](void* state, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce* force, char*) {
    return static_cast<State*>(state)->step(*contacts, *force);
  };
  module.reset = [](void* state) { static_cast<State*>(state)->law.reset(); };
  module.destroy = [](void* state) { delete static_cast<State*>(state); };
  return module;
}

}  // namespace hapbench
