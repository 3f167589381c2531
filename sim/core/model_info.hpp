#pragma once

#include <span>

namespace hapbench {

/// A parameter of a model as the documentation shows it; `name` is the scenario field's path.
struct ParameterInfo {
  const char* name;
  const char* unit;
  const char* default_value;
  const char* range;
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
