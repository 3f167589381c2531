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

/// Keeps Python errors for a caller that reports failures of a law itself, such as a renderer. While an instance
/// exists, a Python error on its thread is kept in the instance: it stops no simulation, and no other call raises it.
/// Instances are local variables of nested calls. Precondition of all members: the interpreter lock is held.
class KeptErrors {
 public:
  KeptErrors();
  ~KeptErrors();
  KeptErrors(const KeptErrors&) = delete;
  KeptErrors& operator=(const KeptErrors&) = delete;

  /// Keeps an exception, unless an earlier exception is kept.
  void keep(const pybind11::object& exception);
  /// Raises the kept exception, if any.
  void raise() const;
  /// Raises the kept exception if it is not derived from the Python class Exception, such as KeyboardInterrupt, because
  /// a program must not ignore it.
  void raise_interrupt() const;

 private:
  KeptErrors* outer_;
  pybind11::object exception_;
};

/// Returns true if a Python error has stopped all calls and at least one of these calls has not yet returned. Returns
/// false while KeptErrors exist on this thread. Precondition: the interpreter lock is held.
bool is_work_stopped();

/// Handles an error of Python code that hapbench has called. If KeptErrors exist on this thread, the error is kept
/// there. Otherwise stores the error, unless an error is already stored, and stops all simulations of this process.
/// Writes the error as text into `fault` (HAPBENCH_FAULT_SIZE characters), unless `fault` is null. Precondition: the
/// interpreter lock is held.
void handle_error(const pybind11::error_already_set& error, char* fault) noexcept;

/// Runs `call` while holding the interpreter lock. If is_work_stopped(), returns false and does not run `call`. An
/// exception of `call` becomes a Python error, for which handle_error() is called. Returns true if `call` returned
/// without an exception.
template <class Call>
bool runs_in_python(const Call& call, char* fault = nullptr) noexcept {
  const pybind11::gil_scoped_acquire held;
  if (is_work_stopped()) return false;
  try {
    call();
    return true;
  } catch (const pybind11::error_already_set& error) {
    handle_error(error, fault);
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
    handle_error(pybind11::error_already_set(), fault);
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
