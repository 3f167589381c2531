#pragma once

#include <span>

#include "sim/core/number_range.hpp"

namespace hapbench {

/// A parameter: the scenario field that sets it, with unit and range.
struct Parameter {
  const char* field;
  NumberRange range;
};

/// What a parameter means to a model.
struct ParameterInfo {
  Parameter parameter;
  const char* meaning;
};

/// The documented parameter block at the top of each model's source file; `hapbench describe NAME` prints it.
struct ModelInfo {
  const char* name;
  const char* summary;
  const char* formula;
  const char* source;  ///< place in the thesis, or the paper
  const char* known_failure;
  std::span<const ParameterInfo> parameters = {};
};

}  // namespace hapbench
