#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/plugin/hapbench_plugin.h"

/// A ForceLaw as a plugin, for laws that are written with hapbench's library. The plugin has its own copy of the
/// library's code and of the contacts, so it need not be built by the compiler, or for the instruction set, of the
/// program that loads it.
namespace hapbench {

/// The functions of a plugin for a class that is derived from ForceLaw and made from K and the values of its own
/// parameters, `Law(double stiffness, std::span<const double> parameters)`. If its constructor or `prepare` throws, the
/// law cannot be created. Of the class's overrides `turning_velocity` and `iterations` are not used.
template <class Law>
class LawPlugin {
 public:
  /// The plugin of a law with these texts and own parameters; `info.parameters` is not used.
  static HapbenchPlugin of(const ModelInfo& info, std::span<const HapbenchParameter> parameters = {}) {
    HapbenchPlugin plugin = {};
    plugin.version = HAPBENCH_PLUGIN_VERSION;
    plugin.gives = HAPBENCH_FORCE;
    plugin.name = info.name;
    plugin.summary = info.summary;
    plugin.formula = info.formula;
    plugin.source = info.source;
    plugin.known_failure = info.known_failure;
    plugin.parameters = parameters.data();
    plugin.parameter_count = parameter_count = parameters.size();
    plugin.create = create;
    plugin.destroy = [](void* law) { delete static_cast<LawPlugin*>(law); };
    plugin.reset = [](void* law) { static_cast<LawPlugin*>(law)->law_.reset(); };
    plugin.evaluate = [](void* law, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer) {
      static_cast<LawPlugin*>(law)->evaluate(*contacts, weights, *answer);
      return 0;
    };
    plugin.springs = [](void* law, const HapbenchContacts*, const double tip[3], double* energy, double moment[3]) {
      const auto& [law_of_this, contacts, spring] = *static_cast<LawPlugin*>(law);
      const SpringState state = law_of_this.spring_state(contacts, spring, Vec3::Map(tip));
      *energy = state.energy;
      Vec3::Map(moment) = state.moment;
    };
    return plugin;
  }

 private:
  LawPlugin(std::span<const double> parameters, double stiffness, std::size_t capacity)
      : law_(stiffness, parameters), contacts_(capacity) {
    law_.prepare(capacity);
  }

  static void* create(const double* parameters, double stiffness, std::size_t capacity) {
    try {
      return new LawPlugin({parameters, parameter_count}, stiffness, capacity);
    } catch (...) {
      return nullptr;
    }
  }

  void evaluate(const HapbenchContacts& given, double* weights, HapbenchForce& answer) noexcept {
    const auto copy = [n = given.n](const auto* from, auto& to) { std::copy_n(from, n, to.begin()); };
    copy(given.index, contacts_.index);
    copy(given.depth, contacts_.depth);
    copy(given.gx, contacts_.ux);
    copy(given.gy, contacts_.uy);
    copy(given.gz, contacts_.uz);
    copy(given.x, contacts_.x);
    copy(given.y, contacts_.y);
    copy(given.z, contacts_.z);
    copy(given.nx, contacts_.nx);
    copy(given.ny, contacts_.ny);
    copy(given.nz, contacts_.nz);
    contacts_.clear();
    contacts_.extend(given.n);
    contacts_.pad();
    const auto [force, S] = law_.evaluate(contacts_);
    spring_ = force;
    std::copy_n(contacts_.weight.begin(), given.n, weights);
    answer = {{force.x(), force.y(), force.z()}, {S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2)}};
  }

  static inline std::size_t parameter_count = 0;

  Law law_;
  ContactBuffer contacts_;      ///< of the last evaluation
  Vec3 spring_ = Vec3::Zero();  ///< of it, too
};

}  // namespace hapbench
