#pragma once

#include <span>

namespace hapbench {

/// Allowed values of a number given by a user; bounds are included unless stated otherwise. The unit is shown to
/// people: an SI unit, "1" for a dimensionless number, empty if it is the unit of another number.
struct NumberRange {
  double min;
  double max;
  const char* unit = "";
  bool above_min = false;  ///< min itself is excluded
};

/// A parameter: the scenario field that sets it, with unit and range.
struct Parameter {
  const char* field;
  NumberRange range;
};

/// The meaning of a parameter in a model.
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
