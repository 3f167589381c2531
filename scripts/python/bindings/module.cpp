#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include "algorithms/module/hapbench_module.h"
#include "algorithms/registry.hpp"
#include "bindings/bindings.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/run_program.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/run_tables.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/field_files.hpp"

/// The engine and the commands of the program for Python. Users call the Python package around it (hapbench/).
namespace hapbench {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

/// Interval at which a waiting call handles signals and reports progress.
constexpr auto kPollInterval = 50ms;

/// Largest wait for running calls before the interpreter ends; bounded because a loaded module may loop
/// forever.
constexpr auto kPatience = 2s;

/// Number of calls that are computing, and the Python error that ends these calls, or null if there is no error. Both
/// are guarded by the interpreter lock. The error is a bare pointer because no interpreter exists any more when the
/// process destroys static objects.
int active_calls = 0;
PyObject* python_error = nullptr;

/// Innermost KeptErrors of this thread that no ActiveCall hides; null if there is none.
thread_local KeptErrors* kept_errors = nullptr;

/// Returns the exception object of an error, with its traceback.
py::object exception_of(const py::error_already_set& error) {
  py::object exception = error.value();
  if (error.trace()) PyException_SetTraceback(exception.ptr(), error.trace().ptr());
  return exception;
}

[[noreturn]] void raise_exception(PyObject* exception) {
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception)), exception);
  throw py::error_already_set();
}

/// Stores an exception, unless an exception is already stored, and stops all simulations of this process.
void stop_work_by(py::object exception) {
  if (python_error == nullptr) python_error = exception.release().ptr();
  stop_work(SIGINT);
}

/// Writes the class and the message of an exception into `fault`.
void write_fault(const py::object& exception, char* fault) noexcept {
  try {
    const std::string name = py::str(py::type::of(exception).attr("__name__")), message = py::str(exception);
    std::snprintf(fault, HAPBENCH_FAULT_SIZE, "%s%s%s", name.c_str(), message.empty() ? "" : ": ", message.c_str());
  } catch (...) {  // the exception has no message that can be written
    std::snprintf(fault, HAPBENCH_FAULT_SIZE, "%s", Py_TYPE(exception.ptr())->tp_name);
  }
}

/// Label, completed work and total work of a progress report; the total is 0 before the first report.
using ProgressState = std::tuple<std::string, std::uint64_t, std::uint64_t>;

/// A call from Python that computes. `active_calls` counts the existing objects of this class. A Python error in one
/// call stops all calls. When the last call ends, the error is cleared and work may start again. An ActiveCall hides
/// the KeptErrors of its thread, because it raises its errors itself. Precondition of constructor and destructor: the
/// interpreter lock is held.
class ActiveCall {
 public:
  ActiveCall() : hidden_(std::exchange(kept_errors, nullptr)) { ++active_calls; }
  ~ActiveCall() {
    kept_errors = hidden_;
    if (--active_calls > 0) return;
    Py_CLEAR(python_error);
    stop_work(0);
  }
  ActiveCall(const ActiveCall&) = delete;
  ActiveCall& operator=(const ActiveCall&) = delete;

 private:
  KeptErrors* hidden_;
};

/// Raises the error that stop_work_by() has stored, if any. Preconditions: an ActiveCall exists, and the interpreter
/// lock is held.
void raise_python_error() {
  if (python_error != nullptr) raise_exception(python_error);
}

/// Runs `work` on a new thread and waits for its end with the interpreter lock released. While supervise() waits, it
/// handles signals and reports progress 20 times a second. Several Python threads may call supervise() at once.
/// `progress` is None for progress bars on a terminal, False for no progress, or a function of (label, done,
/// total). Throws the exception of `work`. An error of a Python law, of the progress function or of a signal
/// handler (such as KeyboardInterrupt) stops the work of all threads and is raised. Precondition: the
/// interpreter lock is held.
void supervise(const py::object& progress, const std::function<void(const ProgressListener*)>& work) {
  const ActiveCall counted;
  const bool has_function = PyCallable_Check(progress.ptr()) != 0;
  std::mutex mutex;
  // `reported`: last report of `work`, guarded by `mutex`. `delivered`: last report that was passed to Python.
  ProgressState reported, delivered;
  const auto last_report = [&] {
    const std::lock_guard lock(mutex);
    return reported;
  };
  const ProgressListener listener = [&](std::string_view label, std::uint64_t done, std::uint64_t total) {
    const std::lock_guard lock(mutex);
    reported = {std::string(label), done, total};
  };
  const ProgressListener* const forwarded = progress.is_none() ? nullptr : &listener;
  // Start the work.
  auto result = std::async(std::launch::async, [&] { work(forwarded); });
  const auto has_ended = [&result] {
    const py::gil_scoped_release released;
    return result.wait_for(kPollInterval) == std::future_status::ready;
  };
  // Handle signals and report progress until the work ends.
  while (!has_ended()) {
    runs_in_python([&] {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      ProgressState last = last_report();
      if (!has_function || last == delivered) return;
      delivered = std::move(last);
      std::apply(progress, delivered);
    });
  }
  raise_python_error();
  result.get();
  if (const auto [label, done, total] = last_report(); has_function && total > 0) progress(label, total, total);
}

/// Exit handler: ends the calls of daemon threads by SystemExit and waits for them at most 2 s, because they
/// would request the interpreter lock of an interpreter that has ended.
void stop_calls_at_exit() {
  if (active_calls == 0) return;
  PyErr_SetNone(PyExc_SystemExit);
  stop_work_by(exception_of(py::error_already_set()));
  const auto latest = std::chrono::steady_clock::now() + kPatience;
  while (active_calls > 0 && std::chrono::steady_clock::now() < latest) {
    const py::gil_scoped_release released;
    std::this_thread::sleep_for(10ms);
  }
}

/// LoadingGuard for Python. Throws InputError while another thread computes. Otherwise returns an object that holds the
/// interpreter lock, so that no other thread can start to compute before the law is loaded.
std::shared_ptr<void> guard_loading() {
  auto held = std::make_shared<py::gil_scoped_acquire>();  // starting work requires this lock
  if (active_calls > 1) throw InputError("a law cannot be loaded while another thread computes");
  return held;
}

/// Translates InputError and IoError into hapbench.ScenarioError and OSError.
void translate_errors() {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const InputError& error) {
      py::list faults;
      for (const InputError& fault : error.faults()) {
        ErrorLocation file = fault.location();
        const std::string field = std::exchange(file.pointer, "");
        faults.append(py::make_tuple(file.text(), field, fault.problem()));
      }
      const py::object type = py::module_::import("hapbench.errors").attr("ScenarioError");
      PyErr_SetObject(type.ptr(), type(faults).ptr());
    } catch (const IoError& error) {
      PyErr_SetString(PyExc_OSError, error.what());
    }
  });
}

/// Returns the name, unit and meaning of each column, and the numbers as an array of rows x columns.
py::tuple table_of(const MemoryTable& table) {
  py::list columns;
  for (const Column& column : table.columns()) columns.append(py::make_tuple(column.name, column.unit, column.meaning));
  return py::make_tuple(columns, py::array_t<double>({table.rows(), table.columns().size()}, table.numbers().data()));
}

/// Runs a scenario and returns its summary, effective scenario, timing, warnings, unmet expectations and
/// recorded tables.
py::dict run(const std::string& scenario, const std::vector<std::string>& overrides, const py::object& progress) {
  Result report;
  RunTables tables;
  std::vector<std::string> warnings;
  const bool shown = progress.ptr() != Py_False;
  supervise(progress, [&](const ProgressListener* listener) {
    // Run the scenario and collect all warnings.
    const CheckedScenario scene = checked(load_scenario(find_scenario(scenario), overrides));
    const LoadedScenario& loaded = scene.loaded();
    warnings = with_files(loaded, loaded.warnings);
    for (std::string& warning : with_files(loaded, scene.file_warnings())) warnings.push_back(std::move(warning));
    report = run_scenario(scene, std::nullopt, {shown, listener}, &tables);
    for (std::string& warning : run_warnings({&report, 1})) warnings.push_back(std::move(warning));
  });
  py::dict result;
  result["summary"] = json_text(summary_json(report));
  result["scenario"] = json_text(tables.effective);
  result["timing"] = timing_text(report);
  result["warnings"] = warnings;
  result["unmet"] = report.unmet;
  // Convert the recorded tables of each trial.
  py::list trials;
  for (const RecordedTables& trial : tables.trials) {
    py::dict recorded;
    for (const auto& [file, table] : trial)
      recorded[py::str(std::filesystem::path(file).stem().string())] = table_of(table);
    trials.append(recorded);
  }
  result["trials"] = trials;
  result["targets"] = tables.targets ? py::object(table_of(*tables.targets)) : py::object(py::none());
  return result;
}

/// Executable file for ProgramContext::program. The Python package sets it; until then, it is the file of the Python
/// interpreter.
std::filesystem::path& program_file() {
  static std::filesystem::path file = file_of_this_process();
  return file;
}

/// Runs a command and returns its status, standard output, warnings and errors.
py::tuple command(const std::vector<std::string>& words, const py::object& progress) {
  CapturedOutput output;
  int status = 0;
  supervise(progress, [&](const ProgressListener* listener) {
    ProgramContext context{
        .program = program_file(), .captured = &output, .progress = listener, .guard_loading = guard_loading};
    status = run_program(words, context);
  });
  return py::make_tuple(status, output.text, output.warnings, output.errors);
}

/// Runs a command that prints on the terminal, and returns its exit status.
int run_main(const std::vector<std::string>& words) {
  int status = 0;
  supervise(py::none(), [&](const ProgressListener* listener) {
    ProgramContext context{.program = program_file(), .progress = listener, .guard_loading = guard_loading};
    status = run_program_to_exit(words, context);
  });
  return status;
}

/// Observer that keeps the latest step with its contacts.
class LastRow final : public Observer {
 public:
  explicit LastRow(std::size_t capacity) : contacts(capacity) {}

  void on_step(const StepRecord& record) noexcept override {
    row = record;
    contacts.assign(*record.rendered);
  }

  StepRecord row;
  ContactBuffer contacts;
};

py::array_t<double> array_of(const Vec3& v) {
  return py::array_t<double>(3, v.data());
}

/// A run that Python advances step by step.
class PythonSimulation {
 public:
  PythonSimulation(const std::string& scenario, const std::vector<std::string>& overrides)
      : loaded_(load_scenario(find_scenario(scenario), overrides)) {
    const ActiveCall counted;
    {
      const py::gil_scoped_release released;
      SimulationParts parts = with_file(loaded_, [&] { return assemble(loaded_.scenario); });
      last_.emplace(parts.source->capacity());
      simulation_.emplace(simulation_config(loaded_.scenario), std::move(parts), std::vector<Observer*>{&*last_});
    }
    raise_python_error();
  }

  bool step() {
    const ActiveCall counted;
    const bool more = simulation_->step();
    raise_python_error();
    return more;
  }

  /// Advances in pieces of kStepsPerStopCheck steps and handles signals between them. Returns the number of computed
  /// steps.
  std::uint64_t advance(std::uint64_t steps) {
    const ActiveCall counted;
    const std::uint64_t first = simulation_->result().rows;
    for (bool more = true; more && steps > 0;) {
      const std::uint64_t piece = std::min(steps, kStepsPerStopCheck);
      {
        const py::gil_scoped_release released;
        more = simulation_->advance(piece);
      }
      steps -= piece;
      raise_python_error();
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
    return simulation_->result().rows - first;
  }

  void reset() {
    const ActiveCall counted;
    simulation_->reset();
    last_->row = {};
    last_->contacts.clear();
    raise_python_error();
  }

  py::dict state() const {
    const StepRecord& r = last_->row;
    py::dict state;
    state["step"] = r.step;
    state["time_s"] = r.time;
    state["position_m"] = array_of(r.tool.pose.position);
    state["velocity_m_per_s"] = array_of(r.tool.velocity);
    state["axis"] = array_of(r.tool.pose.axis);
    state["force_N"] = array_of(r.force.rendered);
    state["spring_force_N"] = array_of(r.force.spring);
    const Mat3& S = r.force.S;  // symmetric
    state["stiffness_tensor"] = py::array_t<double>({3, 3}, S.data());
    state["measured_force_N"] = array_of(r.hand.measured);
    state["input_force_N"] = array_of(r.hand.input);
    state["handle_m"] = array_of(r.handle.position);
    state["colliding"] = r.colliding;
    state["depth_max_m"] = r.force.depth_max;
    return state;
  }

  py::dict contacts() const {
    const ContactBuffer& c = last_->contacts;
    const std::size_t n = c.size();
    py::dict contacts;
    contacts["index"] = py::array_t<std::uint32_t>(static_cast<py::ssize_t>(n), c.index.data());
    const auto array = [n](const auto&... columns) -> py::object {
      return ContactArray(n, sizeof...(columns)).filled(n, {columns.data()...});
    };
    contacts["points_m"] = array(c.x, c.y, c.z);
    contacts["normals"] = array(c.nx, c.ny, c.nz);
    contacts["depths_m"] = array(c.depth);
    contacts["gradients"] = array(c.ux, c.uy, c.uz);
    contacts["weights"] = array(c.weight);
    return contacts;
  }

  std::uint64_t rows() const { return simulation_->result().rows; }
  double step_size() const { return loaded_.scenario.time.step; }
  std::uint64_t steps() const { return static_cast<std::uint64_t>(loaded_.scenario.time.steps); }
  std::string outcome() const { return std::string(outcome_name(outcome_of(simulation_->result().ending))); }

 private:
  LoadedScenario loaded_;
  std::optional<LastRow> last_;
  std::optional<Simulation> simulation_;
};

/// Defines the class Simulation; hapbench.Simulation documents its members.
void bind_simulation(py::module_& module) {
  py::class_<PythonSimulation>(module, "Simulation")
      .def(py::init<const std::string&, const std::vector<std::string>&>(), py::arg("scenario"), py::arg("overrides"))
      .def("step", &PythonSimulation::step)
      .def("advance", &PythonSimulation::advance, py::arg("steps"))
      .def("reset", &PythonSimulation::reset)
      .def_property_readonly("state", &PythonSimulation::state)
      .def_property_readonly("contacts", &PythonSimulation::contacts)
      .def_property_readonly("rows", &PythonSimulation::rows)
      .def_property_readonly("time_step_s", &PythonSimulation::step_size)
      .def_property_readonly("steps", &PythonSimulation::steps)
      .def_property_readonly("outcome", &PythonSimulation::outcome);
}

}  // namespace

KeptErrors::KeptErrors() : outer_(std::exchange(kept_errors, this)) {}

KeptErrors::~KeptErrors() {
  kept_errors = outer_;
}

void KeptErrors::keep(const py::object& exception) {
  if (!exception_) exception_ = exception;
}

void KeptErrors::raise() const {
  if (exception_) raise_exception(exception_.ptr());
}

void KeptErrors::raise_interrupt() const {
  if (exception_ && PyErr_GivenExceptionMatches(exception_.ptr(), PyExc_Exception) == 0) raise();
}

bool is_work_stopped() {
  return kept_errors == nullptr && python_error != nullptr;
}

void handle_error(const py::error_already_set& error, char* fault) noexcept {
  const py::object exception = exception_of(error);
  if (fault != nullptr) write_fault(exception, fault);
  if (kept_errors != nullptr)
    kept_errors->keep(exception);
  else
    stop_work_by(exception);
}

bool is_call_active() {
  return active_calls > 0;
}

}  // namespace hapbench

PYBIND11_MODULE(_hapbench, module) {
  using namespace hapbench;
  module.doc() = "The compiled part of hapbench: use the package around it.";
  translate_errors();
  py::module_::import("atexit").attr("register")(py::cpp_function(stop_calls_at_exit));
  module.def(
      "set_program", [](const std::string& program) { program_file() = program; }, py::arg("program"),
      "Say which file is the program, for commands that name it.");
  module.def("run", run, py::arg("scenario"), py::arg("overrides"), py::arg("progress"),
             "Run a scenario and keep what it records in memory.");
  module.def("command", command, py::arg("words"), py::arg("progress"),
             "Run a command of the program; returns status, standard output, warnings and errors.");
  module.def("main", run_main, py::arg("words"), "Be the program: print on the terminal and return the exit status.");
  module.def(
      "algorithms", [] { return algorithm_names(); }, "The names of all algorithms there are.");
  module.def("allow_modules", allow_all_modules, "Allow all libraries that scenarios name, as --allow-modules does.");
  bind_force_laws(module);
  bind_simulation(module);
  bind_renderer(module);
}
