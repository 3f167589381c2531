#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstddef>
#include <exception>
#include <limits>
#include <vector>

/// The parts of the compiled module.
namespace hapbench {

/// A numpy array with `width` numbers for each contact, of which Python gets a view of the first rows. Precondition of
/// everything: the interpreter is held.
class ContactArray {
 public:
  using Columns = std::array<const double*, 3>;  ///< the first `width` of them count

  ContactArray(std::size_t capacity, pybind11::ssize_t width) : width_(width), numbers_(shape(capacity)) {}

  /// The view of the first n rows, filled from the columns; reused while n stays the same.
  const pybind11::object& filled(std::size_t n, const Columns& columns) {
    double* out = numbers_.mutable_data();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < static_cast<std::size_t>(width_); ++j) *out++ = columns[j][i];
    }
    if (n != rows_) {
      view_ = pybind11::array_t<double>(shape(n), numbers_.data(), numbers_);
      rows_ = n;
    }
    return view_;
  }

 private:
  std::vector<pybind11::ssize_t> shape(std::size_t rows) const {
    const auto n = static_cast<pybind11::ssize_t>(rows);
    return width_ == 1 ? std::vector{n} : std::vector{n, width_};
  }

  pybind11::ssize_t width_;
  pybind11::array_t<double> numbers_;
  pybind11::object view_;
  std::size_t rows_ = std::numeric_limits<std::size_t>::max();
};

/// Keeps an error of Python, unless one is kept already, and stops all work. Precondition: the interpreter is held.
void stop_work_by(const pybind11::error_already_set& error);

/// True from an error of Python to the end of the work that it stops. Precondition: the interpreter is held.
bool is_work_stopped();

/// Runs `call` with the interpreter held, unless work is stopped. An exception becomes a Python error and stops all
/// work. Returns whether `call` ended without one.
template <class Call>
bool runs_in_python(const Call& call) noexcept {
  const pybind11::gil_scoped_acquire held;
  if (is_work_stopped()) return false;
  try {
    call();
    return true;
  } catch (const pybind11::error_already_set& error) {
    stop_work_by(error);
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
    stop_work_by(pybind11::error_already_set());
  }
  return false;
}

/// True while a call is under way. Precondition: the interpreter is held.
bool is_work_under_way();

/// Adds the function that makes an algorithm of a Python function.
void bind_force_laws(pybind11::module_& module);

}  // namespace hapbench
