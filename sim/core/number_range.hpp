#pragma once

namespace hapbench {

/// Where a number given from outside may lie; bounds are included unless said otherwise. The unit is for people: an SI
/// unit, "1" for numbers that have none, or empty where it is another number's.
struct NumberRange {
  double min;
  double max;
  const char* unit = "";
  bool above_min = false;  ///< min itself is excluded
};

}  // namespace hapbench
