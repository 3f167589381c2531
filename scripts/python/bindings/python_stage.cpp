#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <limits>

#include "algorithms/stages/force_stage.hpp"
#include "bindings/bindings.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;

/// A force stage in Python: `make`, called with the config as JSON text, gives the callable of a run.
struct StageDefinition {
  std::string name;
  py::object make;
  std::vector<std::string> arguments;  ///< of the callable, in their order
};

constexpr std::pair<const char*, double (HapbenchStageStep::*)[3]> kStageVectors[] = {
    {"force", &HapbenchStageStep::force},
    {"spring", &HapbenchStageStep::spring},
    {"position", &HapbenchStageStep::position},
    {"velocity", &HapbenchStageStep::velocity},
    {"device_position", &HapbenchStageStep::device_position},
    {"device_velocity", &HapbenchStageStep::device_velocity},
    {"device_force", &HapbenchStageStep::device_force}};

/// What a stage asks for, by the name of its argument, one of those of hapbench.force_stage.
py::object stage_argument(const std::string& name, const HapbenchStageStep& s, const HapbenchStageRun& run) {
  for (const auto& [known, vector] : kStageVectors)
    if (name == known) return py::array_t<double>(3, s.*vector);
  if (name == "tensor") {
    const auto& [xx, xy, xz, yy, yz, zz] = s.stiffness;
    const double all[] = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
    return py::array_t<double>({3, 3}, all);
  }
  if (name == "in_contact") return py::bool_(s.in_contact != 0);
  if (name == "row") return py::int_(s.row);
  return py::float_(name == "energy"      ? s.energy
                    : name == "time_step" ? run.time_step
                    : name == "mass"      ? run.mass
                                          : run.stiffness);
}

class PythonStage final : public ForceStage {
 public:
  PythonStage(std::shared_ptr<const StageDefinition> definition, std::string config)
      : definition_(std::move(definition)), config_(std::move(config)) {}

  void prepare(const HapbenchStageRun& run) override { run_ = run; }

  void reset() noexcept override {
    failed_ = !runs_in_python([this] { callable_ = shared_by_threads(definition_->make(config_)); });
  }

  Vec3 force(const HapbenchStageStep& step) noexcept override {
    Vec3 answer = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    if (!failed_) failed_ = !runs_in_python([&] { answer = answered(step); });
    return answer;
  }

 private:
  Vec3 answered(const HapbenchStageStep& step) const {
    py::tuple arguments(definition_->arguments.size());
    for (std::size_t i = 0; i < arguments.size(); ++i)
      arguments[i] = stage_argument(definition_->arguments[i], step, run_);
    const py::object answer = (*callable_)(*arguments);
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
  std::shared_ptr<const py::object> callable_;
  bool failed_ = false;
};

void add_python_stage(const std::string& name, const py::object& make, const std::vector<std::string>& arguments) {
  if (is_work_under_way()) throw std::runtime_error("a force stage cannot be defined while something is computed");
  add_force_stage(name, [shared = shared_by_threads(StageDefinition{name, make, arguments})](
                            const std::string& config) { return std::make_unique<PythonStage>(shared, config); });
}

}  // namespace

void bind_force_stages(py::module_& module) {
  module.def("add_force_stage", add_python_stage, py::arg("name"), py::arg("make"), py::arg("arguments"),
             "Make a force stage of a callable; hapbench.force_stage checks and fills the arguments.");
}

}  // namespace hapbench
