#pragma once

#include <pybind11/pybind11.h>

namespace hapbench {

/// Adds the class Simulation.
void bind_simulation(pybind11::module_& module);

}  // namespace hapbench
