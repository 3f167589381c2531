#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <memory>
#include <utility>

/// The parts of the compiled module.
namespace hapbench {

/// Gives back what a thread that ends has kept of the interpreter. Once the interpreter is about to end, that is left
/// to it: a thread that waited for it would end the process. Precondition: the thread does not hold the interpreter.
void give_back(PyThreadState* state, PyGILState_STATE before) noexcept;

/// Holds the interpreter. Each thread keeps its thread state, because making one takes longer than calling a law.
class Held {
 public:
  Held() {
    thread_local const Kept kept;
    state_ = PyGILState_Ensure();
  }
  ~Held() { PyGILState_Release(state_); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  struct Kept {
    // A thread that was made by Python has a state already.
    Kept() : made(PyGILState_GetThisThreadState() == nullptr) {
      if (!made) return;
      gil = PyGILState_Ensure();
      state = PyEval_SaveThread();
    }
    ~Kept() {
      if (made) give_back(state, gil);
    }
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;

    bool made;
    PyGILState_STATE gil = PyGILState_UNLOCKED;
    PyThreadState* state = nullptr;
  };

  PyGILState_STATE state_;
};

/// A value of Python objects of which any thread may release the last reference. It is destroyed only while there is an
/// interpreter.
template <class Value>
std::shared_ptr<const Value> shared_by_threads(Value value) {
  return {new Value(std::move(value)), [](const Value* last) {
            if (!Py_IsInitialized()) return;  // the interpreter has destroyed its objects
            const Held held;
            delete last;
          }};
}

/// Counts a call that computes. An error of Python in one of them ends all of them; the end of the last one lets work
/// begin again. Precondition of both ends: the interpreter is held.
class UnderWay {
 public:
  UnderWay();
  ~UnderWay();
  UnderWay(const UnderWay&) = delete;
  UnderWay& operator=(const UnderWay&) = delete;
};

/// Calls `work` on a thread of its own, with the interpreter released, and waits for it. Several threads of Python may
/// call it at once. While it waits, it handles signals and progress several times a second. `progress`: None for bars
/// on a terminal, False for none, or a function of (label, done, total). Throws what `work` throws. An error of a
/// Python law, of the progress function or of a signal handler, such as KeyboardInterrupt, ends the work and is raised;
/// it also ends the work of other threads. Precondition: the interpreter is held.
void supervise(const pybind11::object& progress, const std::function<void()>& work);

/// Keeps the Python error that is set, unless one is kept already, and stops all work. Precondition: the interpreter is
/// held.
void stop_by_python_error();

/// Runs `call` with the interpreter held. After an exception, which becomes a Python error and stops all work, returns
/// false.
template <class Call>
bool runs_in_python(const Call& call) noexcept {
  const Held held;
  try {
    call();
    return true;
  } catch (pybind11::error_already_set& error) {
    error.restore();
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  }
  stop_by_python_error();
  return false;
}

/// Raises the error that stop_by_python_error has kept, if any. Precondition: the interpreter is held by a call that is
/// under way.
void raise_python_error();

/// True while a call is under way. Precondition: the interpreter is held.
bool is_work_under_way();

/// Ends the calls of daemon threads by SystemExit before the interpreter ends, or waits two seconds for it: each would
/// ask for the interpreter then.
void end_work_before_interpreter();

/// Makes loading of plugins and computing by another thread exclude each other.
void guard_plugins();

/// Adds the function that makes an algorithm of a Python function.
void bind_force_laws(pybind11::module_& module);

/// Adds the class Simulation.
void bind_simulation(pybind11::module_& module);

}  // namespace hapbench
