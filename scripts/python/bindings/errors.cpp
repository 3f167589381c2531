
#include <pybind11/pybind11.h>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;

void raise(const InputError& error) {
  py::list faults;
  for (const InputError& fault : error.faults()) faults.append(py::make_tuple(fault.place(), fault.problem()));
  const py::object type = py::module_::import("hapbench.errors").attr("ScenarioError");
  PyErr_SetObject(type.ptr(), type(faults).ptr());
}

}  // namespace

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const InputError& error) {
      raise(error);
    } catch (const IoError& error) {
      PyErr_SetString(PyExc_OSError, error.what());
    }
  });
}

}  // namespace hapbench
