#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstddef>
#include <exception>
#include <limits>
#include <vector>

/// Declarations that the sources of the compiled Python module share.
namespace hapbench {

/// A numpy array with `width` numbers for each contact (1: scalars, 3: vectors). Python receives a view of its
/// first rows, one row for each current contact. Precondition of all members: the interpreter lock is held.
class ContactArray {
 public:
  using Columns = std::array<const double*, 3>;  ///< only the first `width` pointers are used

  ContactArray(std::size_t capacity, pybind11::ssize_t width) : width_(width), numbers_(shape(capacity)) {}

  /// Copies n values of each column and returns a view of the first n rows. The view object is reused while n
  /// stays the same. Precondition: n is at most the capacity.
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

/// Stores a Python error, unless an error is already stored, and stops all simulations of this process.
/// Precondition: the interpreter lock is held.
void stop_work_by(const pybind11::error_already_set& error);

/// Returns true if a Python error has stopped all calls and at least one of these calls has not yet returned.
/// Precondition: the interpreter lock is held.
bool is_work_stopped();

/// Runs `call` while holding the interpreter lock. If is_work_stopped(), returns false and does not run `call`. An
/// exception of `call` becomes a Python error and stops all work. Returns true if `call` returned without an exception.
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

/// Returns true while a call from Python is computing. Precondition: the interpreter lock is held.
bool is_call_active();

/// Adds the class Renderer; hapbench.Renderer documents its members.
void bind_renderer(pybind11::module_& module);

/// Adds the Python function add_force_law(), which makes an algorithm from a Python callable.
void bind_force_laws(pybind11::module_& module);

}  // namespace hapbench
