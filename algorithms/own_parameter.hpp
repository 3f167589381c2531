#pragma once

#include "algorithms/rendering_config.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

/// A parameter that belongs to one algorithm alone and is no member of RenderingConfig: a number, the field
/// rendering.parameters.<algorithm>.<name> of a scenario.
struct OwnParameter {
  const char* name;
  NumberRange range;
  double initial;  ///< its default
  const char* meaning;
};

/// The value `config` gives, or the default.
inline double own_value(const RenderingConfig& config, const char* algorithm, const OwnParameter& parameter) {
  const auto own = config.parameters.find(algorithm);
  if (own == config.parameters.end()) return parameter.initial;
  const auto value = own->second.find(parameter.name);
  return value == own->second.end() ? parameter.initial : value->second;
}

}  // namespace hapbench
