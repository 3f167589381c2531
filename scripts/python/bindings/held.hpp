#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

namespace hapbench {

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
      if (!made || !Py_IsInitialized()) return;
      PyEval_RestoreThread(state);
      PyGILState_Release(gil);
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

}  // namespace hapbench
