#include <pybind11/stl.h>

#include <algorithm>
#include <optional>

#include "bindings/bindings.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;

/// Keeps the last row, with its contacts.
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

/// A run, step by step.
class PythonSimulation {
 public:
  PythonSimulation(const std::string& scenario, const std::vector<std::string>& overrides)
      : loaded_(load_scenario(find_scenario(scenario), overrides)) {
    const UnderWay counted;
    {
      const py::gil_scoped_release released;
      SimulationParts parts = with_file(loaded_, [&] { return assemble(loaded_.scenario); });
      last_.emplace(parts.source->capacity());
      simulation_.emplace(simulation_config(loaded_.scenario), std::move(parts), std::vector<Observer*>{&*last_});
    }
    raise_python_error();
  }

  bool step() {
    const UnderWay counted;
    const bool more = simulation_->step();
    raise_python_error();
    return more;
  }

  /// Computes in pieces, between which signals are handled.
  std::uint64_t advance(std::uint64_t steps) {
    const UnderWay counted;
    const std::uint64_t first = simulation_->result().rows;
    for (bool more = true; more && steps > 0;) {
      const std::uint64_t piece = std::min(steps, kAskEvery);
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
    const UnderWay counted;
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
  std::string outcome() const { return std::string(outcome_name(simulation_->result().outcome)); }

 private:
  LoadedScenario loaded_;
  std::optional<LastRow> last_;
  std::optional<Simulation> simulation_;
};

}  // namespace

/// hapbench.Simulation says what they do.
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

}  // namespace hapbench
