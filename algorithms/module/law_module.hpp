#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/module/hapbench_module.h"

namespace hapbench {

/// Returns the module table for a class `Law` that is derived from ForceLaw and has the constructor `Law(double
/// stiffness, const double* values)`; `values` are the values of its parameters. `info.parameters` is not used.
/// Only the overrides of `evaluate`, `prepare`, `reset` and `gives_weights` are called. An exception ends the
/// run.
///
/// The module contains its own copy of hapbench's code and copies the contacts. It may therefore be built with
/// another compiler, or for another instruction set, than the program that loads it.
template <class Law>
HapbenchModule law_module(const ModelInfo& info, std::span<const HapbenchParameter> parameters = {}) {
  struct State {
    Law law;
    ContactBuffer contacts;

    int step(HapbenchContacts& given, HapbenchForce& answer) {
      std::copy_n(given.index, given.n, contacts.index.begin());
      const std::pair<const double*, AlignedDoubles&> columns[] = {
          {given.depth, contacts.depth}, {given.gx, contacts.ux}, {given.gy, contacts.uy}, {given.gz, contacts.uz},
          {given.x, contacts.x},         {given.y, contacts.y},   {given.z, contacts.z},   {given.nx, contacts.nx},
          {given.ny, contacts.ny},       {given.nz, contacts.nz}};
      for (const auto& [from, to] : columns) std::copy_n(from, given.n, to.begin());
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
