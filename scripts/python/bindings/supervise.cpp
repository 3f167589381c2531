#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "bindings/bindings.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/plugins/load_plugin.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

/// Interval of handling signals and progress.
constexpr auto kLookEvery = 50ms;

/// Time that work has to end before the interpreter does: a plugin may loop.
constexpr auto kPatience = 2s;

/// The number of calls under way, and the error that ends them. Both are guarded by the lock of the interpreter.
int under_way = 0;
/// Null if there is none. A bare pointer, because at the end of the process there is no interpreter.
PyObject* python_error = nullptr;

std::mutex ending_mutex;
/// True once the interpreter is about to end. Guarded by ending_mutex.
bool interpreter_ends = false;

/// The last progress that the work reported.
class ProgressBoard final : public ProgressListener {
 public:
  struct State {
    std::string label;
    std::uint64_t done = 0, total = 0;
  };

  void progress(std::string_view label, std::uint64_t done, std::uint64_t total) noexcept override {
    const std::lock_guard lock(mutex_);
    length_ = std::min(label.size(), label_.size());
    std::copy_n(label.begin(), length_, label_.begin());
    done_ = done;
    total_ = total;
  }

  /// The last report, if there is one.
  std::optional<State> last() {
    const std::lock_guard lock(mutex_);
    if (total_ == 0) return std::nullopt;
    return State{{label_.data(), length_}, done_, total_};
  }
  /// The last report, unless it was taken before.
  std::optional<State> take() {
    const auto state = last();
    const bool is_new =
        state && (state->done != taken_.done || state->total != taken_.total || state->label != taken_.label);
    if (!is_new) return std::nullopt;
    taken_ = *state;
    return state;
  }

 private:
  std::mutex mutex_;
  std::array<char, 256> label_;
  std::size_t length_ = 0;
  std::uint64_t done_ = 0, total_ = 0;
  State taken_;
};

/// Runs work on a thread of its own.
class Worker {
 public:
  Worker(ProgressListener* listener, const std::function<void()>& work)
      : thread_([this, listener, &work] { run(listener, work); }) {}
  ~Worker() { join(); }

  /// Waits for kLookEvery at most; returns true if the work has ended.
  bool wait() {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, kLookEvery, [this] { return has_ended_; });
  }
  void join() {
    if (thread_.joinable()) thread_.join();
  }
  const std::exception_ptr& failure() const { return failure_; }

 private:
  void run(ProgressListener* listener, const std::function<void()>& work) {
    report_progress_to(listener);
    try {
      work();
    } catch (...) {
      failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    ended_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

void tell(const py::object& progress, ProgressBoard& board) {
  if (const auto state = board.take(); state && PyCallable_Check(progress.ptr()))
    progress(state->label, state->done, state->total);
}

/// Handles signals and progress. Precondition: the interpreter is held.
void look_after(const py::object& progress, ProgressBoard& board) {
  if (python_error != nullptr) return;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    tell(progress, board);
  } catch (py::error_already_set& error) {
    error.restore();
    stop_by_python_error();
  }
}

void end_work() {
  {
    const py::gil_scoped_release released;  // for the thread that gives back its state
    const std::lock_guard lock(ending_mutex);
    interpreter_ends = true;
  }
  if (under_way == 0) return;
  PyErr_SetNone(PyExc_SystemExit);
  stop_by_python_error();
  const auto latest = std::chrono::steady_clock::now() + kPatience;
  while (under_way > 0 && std::chrono::steady_clock::now() < latest) {
    const py::gil_scoped_release released;
    std::this_thread::sleep_for(10ms);
  }
}

}  // namespace

void give_back(PyThreadState* state, PyGILState_STATE before) noexcept {
  const std::lock_guard lock(ending_mutex);
  if (interpreter_ends) return;
  PyEval_RestoreThread(state);
  PyGILState_Release(before);
}

UnderWay::UnderWay() {
  ++under_way;
}

UnderWay::~UnderWay() {
  if (--under_way > 0) return;
  Py_CLEAR(python_error);
  stop_work(0);
}

void supervise(const py::object& progress, const std::function<void()>& work) {
  const UnderWay counted;
  ProgressBoard board;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release released;
    Worker worker(progress.is_none() ? nullptr : &board, work);
    while (!worker.wait()) {
      const py::gil_scoped_acquire held;
      look_after(progress, board);
    }
    worker.join();
    failure = worker.failure();
  }
  raise_python_error();
  if (failure) {
    try {
      std::rethrow_exception(failure);
    } catch (const Stopped&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
      throw py::error_already_set();
    }
  }
  if (const auto last = board.last(); last && PyCallable_Check(progress.ptr()))
    progress(last->label, last->total, last->total);
}

void stop_by_python_error() {
  PyObject *type, *value, *traceback;
  PyErr_Fetch(&type, &value, &traceback);
  PyErr_NormalizeException(&type, &value, &traceback);
  if (traceback != nullptr) PyException_SetTraceback(value, traceback);
  Py_XDECREF(traceback);
  Py_XDECREF(type);
  if (python_error == nullptr) {
    python_error = value;
  } else {
    Py_XDECREF(value);
  }
  stop_work(SIGINT);
}

void raise_python_error() {
  if (python_error == nullptr) return;
  PyErr_Restore(Py_NewRef(reinterpret_cast<PyObject*>(Py_TYPE(python_error))), Py_NewRef(python_error),
                PyException_GetTraceback(python_error));
  throw py::error_already_set();
}

bool is_work_under_way() {
  return under_way > 0;
}

void end_work_before_interpreter() {
  py::module_::import("atexit").attr("register")(py::cpp_function(end_work));
}

void guard_plugins() {
  guard_loading([] {
    auto held = std::make_shared<py::gil_scoped_acquire>();  // which work needs to begin
    if (under_way > 1) throw InputError("a plugin cannot be loaded while another thread computes");
    return held;
  });
}

}  // namespace hapbench
