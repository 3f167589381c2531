#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <limits>

#include "algorithms/stages/force_stage.hpp"
#include "bindings/bindings.hpp"
#include "bindings/held.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;

/// A force stage in Python: `make`, called with the config as JSON text, gives the callable of a run.
struct StageDefinition {
  std::string name;
  py::object make;
  std::vector<std::string> arguments;  ///< of the callable, in their order
};

py::object vector_of(const double (&numbers)[3]) {
  return py::array_t<double>(3, numbers);
}

/// What a stage may ask for, by the names of its arguments.
const std::pair<const char*, py::object (*)(const HapbenchStageStep&, const HapbenchStageRun&)> kStageArguments[] = {
    {"force", [](const auto& s, const auto&) { return vector_of(s.force); }},
    {"spring", [](const auto& s, const auto&) { return vector_of(s.spring); }},
    {"tensor",
     [](const auto& s, const auto&) -> py::object {
       const auto& [xx, xy, xz, yy, yz, zz] = s.stiffness;
       const double all[] = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
       return py::array_t<double>({3, 3}, all);
     }},
    {"position", [](const auto& s, const auto&) { return vector_of(s.position); }},
    {"velocity", [](const auto& s, const auto&) { return vector_of(s.velocity); }},
    {"device_position", [](const auto& s, const auto&) { return vector_of(s.device_position); }},
    {"device_velocity", [](const auto& s, const auto&) { return vector_of(s.device_velocity); }},
    {"device_force", [](const auto& s, const auto&) { return vector_of(s.device_force); }},
    {"energy", [](const auto& s, const auto&) -> py::object { return py::float_(s.energy); }},
    {"in_contact", [](const auto& s, const auto&) -> py::object { return py::bool_(s.in_contact != 0); }},
    {"row", [](const auto& s, const auto&) -> py::object { return py::int_(s.row); }},
    {"time_step", [](const auto&, const auto& r) -> py::object { return py::float_(r.time_step); }},
    {"mass", [](const auto&, const auto& r) -> py::object { return py::float_(r.mass); }},
    {"stiffness", [](const auto&, const auto& r) -> py::object { return py::float_(r.stiffness); }}};

class PythonStage final : public ForceStage {
 public:
  PythonStage(std::shared_ptr<const StageDefinition> definition, std::string config)
      : definition_(std::move(definition)), config_(std::move(config)) {}
  ~PythonStage() override {
    if (!Py_IsInitialized()) {
      callable_.release();
      return;
    }
    const Held held;
    callable_ = py::object();
  }
  PythonStage(const PythonStage&) = delete;
  PythonStage& operator=(const PythonStage&) = delete;

  void prepare(const HapbenchStageRun& run) override { run_ = run; }

  void reset() noexcept override {
    failed_ = false;
    guarded([this] { callable_ = definition_->make(config_); });
  }

  Vec3 force(const HapbenchStageStep& step) noexcept override {
    Vec3 answer = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    if (!failed_) guarded([&] { answer = answered(step); });
    return answer;
  }

 private:
  /// Runs `call` with the interpreter; an exception ends the work and is raised in Python.
  template <class Call>
  void guarded(const Call& call) noexcept {
    const Held held;
    try {
      return call();
    } catch (py::error_already_set& error) {
      error.restore();
    } catch (const std::exception& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
    stop_by_python_error();
    failed_ = true;
  }

  Vec3 answered(const HapbenchStageStep& step) const {
    py::tuple arguments(definition_->arguments.size());
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      const auto named = [&](const auto& known) { return definition_->arguments[i] == known.first; };
      arguments[i] = std::find_if(std::begin(kStageArguments), std::end(kStageArguments), named)->second(step, run_);
    }
    const py::object answer = callable_(*arguments);
    const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(answer);
    if (!numbers || numbers.ndim() != 1 || numbers.size() != 3 || !Vec3::Map(numbers.data()).allFinite()) {
      PyErr_Clear();
      throw py::value_error("force stage \"" + definition_->name + "\": got " + py::repr(answer).cast<std::string>() +
                            "; allowed: three finite numbers, the force");
    }
    return Vec3::Map(numbers.data());
  }

  std::shared_ptr<const StageDefinition> definition_;
  std::string config_;
  HapbenchStageRun run_{};
  py::object callable_;
  bool failed_ = false;
};

void add_python_stage(const std::string& name, const py::object& make, const std::vector<std::string>& arguments) {
  if (is_work_under_way()) throw std::runtime_error("a force stage cannot be defined while something is computed");
  add_force_stage(name, [shared = shared_by_threads(StageDefinition{name, make, arguments})](
                            const std::string& config) { return std::make_unique<PythonStage>(shared, config); });
}

}  // namespace

void bind_force_stages(py::module_& module) {
  py::list names;
  for (const auto& [name, argument] : kStageArguments) names.append(name);
  module.attr("stage_arguments") = py::tuple(names);
  module.def("add_force_stage", add_python_stage, py::arg("name"), py::arg("make"), py::arg("arguments"),
             "Make a force stage of a callable; hapbench.force_stage checks and fills the arguments.");
}

}  // namespace hapbench
