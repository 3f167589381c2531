#include <chrono>
#include <csignal>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>

#include "bindings/bindings.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

/// Interval of handling signals and progress.
constexpr auto kLookEvery = 50ms;

/// Time that work has to end before the interpreter does: a module may loop.
constexpr auto kPatience = 2s;

/// The number of calls under way, and the error that ends them, null if there is none. Both are guarded by the lock of
/// the interpreter. A bare pointer, because at the end of the process there is no interpreter.
int under_way = 0;
PyObject* python_error = nullptr;

/// Label, done and total; the total is 0 before the first report.
using ProgressState = std::tuple<std::string, std::uint64_t, std::uint64_t>;

void end_work() {
  if (under_way == 0) return;
  PyErr_SetNone(PyExc_SystemExit);
  stop_work_by(py::error_already_set());
  const auto latest = std::chrono::steady_clock::now() + kPatience;
  while (under_way > 0 && std::chrono::steady_clock::now() < latest) {
    const py::gil_scoped_release released;
    std::this_thread::sleep_for(10ms);
  }
}

}  // namespace

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
  const bool is_told = PyCallable_Check(progress.ptr()) != 0;
  std::mutex mutex;
  ProgressState reported, told;  // the work's last report, under the lock, and what Python was told
  const auto last_report = [&] {
    const std::lock_guard lock(mutex);
    return reported;
  };
  const ProgressListener listener = [&](std::string_view label, std::uint64_t done, std::uint64_t total) {
    const std::lock_guard lock(mutex);
    reported = {std::string(label), done, total};
  };
  auto result = std::async(std::launch::async, [&] {
    report_progress_to(progress.is_none() ? nullptr : &listener);
    work();
  });
  const auto has_ended = [&result] {
    const py::gil_scoped_release released;
    return result.wait_for(kLookEvery) == std::future_status::ready;
  };
  while (!has_ended()) {
    runs_in_python([&] {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      ProgressState last = last_report();
      if (!is_told || last == told) return;
      told = std::move(last);
      std::apply(progress, told);
    });
  }
  raise_python_error();
  result.get();
  if (const auto [label, done, total] = last_report(); is_told && total > 0) progress(label, total, total);
}

void stop_work_by(const py::error_already_set& error) {
  if (python_error == nullptr) {
    python_error = py::object(error.value()).release().ptr();
    if (error.trace()) PyException_SetTraceback(python_error, error.trace().ptr());
  }
  stop_work(SIGINT);
}

bool is_work_stopped() {
  return python_error != nullptr;
}

void raise_python_error() {
  if (python_error == nullptr) return;
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(python_error)), python_error);
  throw py::error_already_set();
}

bool is_work_under_way() {
  return under_way > 0;
}

void end_work_before_interpreter() {
  py::module_::import("atexit").attr("register")(py::cpp_function(end_work));
}

void guard_law_loading() {
  guard_loading([] {
    auto held = std::make_shared<py::gil_scoped_acquire>();  // which work needs to begin
    if (under_way > 1) throw InputError("a law cannot be loaded while another thread computes");
    return held;
  });
}

}  // namespace hapbench
