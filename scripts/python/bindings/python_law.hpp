#pragma once

#include <pybind11/pybind11.h>

namespace hapbench {

/// Adds what makes an algorithm of a Python function.
void bind_force_laws(pybind11::module_& module);

}  // namespace hapbench
