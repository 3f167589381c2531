#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bindings/bindings.hpp"
#include "device_model/live/hapbench_renderer.h"
#include "scenarios/input/input_error.hpp"

/// The renderer of haptic loops for Python: the functions of hapbench_renderer.h.
namespace hapbench {
namespace {

namespace py = pybind11;

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

constexpr const char* kStatusNames[] = {"WAITING", "RAMPING", "ON", "CLAMPED", "STALE", "FAULT"};

HapbenchPose3 pose_of(const Vector& position, const Quaternion& orientation) {
  HapbenchPose3 pose = {};
  std::copy(position.begin(), position.end(), pose.position);
  std::copy(orientation.begin(), orientation.end(), pose.orientation);
  return pose;
}

py::array_t<double> array_of(const double (&v)[3]) {
  return py::array_t<double>(3, v);
}

/// Limits of the mount in the order of HapbenchMount: max_force, max_force_rate, ramp_s, stale_s, engage_force.
using MountLimits = std::array<double, 5>;

class PythonRenderer {
 public:
  PythonRenderer(const std::string& scenario, const std::vector<std::string>& overrides, std::uint32_t mode,
                 std::uint32_t flags, const std::pair<Vector, Quaternion>& world_from_device, double scale,
                 const std::pair<Vector, Quaternion>& handle_from_tip, const MountLimits& limits) {
    std::vector<const char*> list;
    for (const std::string& text : overrides) list.push_back(text.c_str());
    list.push_back(nullptr);
    HapbenchSetup setup = HAPBENCH_SETUP_INIT;
    setup.mode = mode;
    setup.flags = flags;
    setup.scenario = scenario.c_str();
    setup.overrides = list.data();
    setup.mount = {pose_of(world_from_device.first, world_from_device.second),
                   scale,
                   pose_of(handle_from_tip.first, handle_from_tip.second),
                   limits[0],
                   limits[1],
                   limits[2],
                   limits[3],
                   limits[4]};
    std::array<char, HAPBENCH_ERROR_SIZE> error{};
    KeptErrors errors;
    renderer_.reset(hapbench_renderer_open(&setup, error.data()));
    errors.raise();  // a law whose object cannot be created
    if (!renderer_) throw InputError(error.data());
  }

  py::dict step(std::uint64_t time_ns, const Vector& position, const Quaternion& orientation,
                const std::array<std::optional<Vector>, 4>& given, std::uint32_t bits) {
    input_ = {};
    input_.time_ns = time_ns;
    input_.handle = pose_of(position, orientation);
    input_.has = bits;
    double* const vectors[] = {input_.velocity, input_.angular_velocity, input_.hand_force, input_.applied_force};
    for (std::uint32_t i = 0; i < given.size(); ++i) {
      if (!given[i]) continue;
      input_.has |= 1u << i;
      std::copy(given[i]->begin(), given[i]->end(), vectors[i]);
    }
    // An exception of a law is a FAULT of this renderer. Only an exception such as KeyboardInterrupt is also raised.
    KeptErrors errors;
    hapbench_renderer_step(renderer_.get(), &input_, &output_);
    errors.raise_interrupt();
    py::dict result;
    result["force_N"] = array_of(output_.force);
    result["torque_N_m"] = array_of(output_.torque);
    result["set_position_m"] = array_of(output_.set_position);
    result["set_velocity_m_per_s"] = array_of(output_.set_velocity);
    result["gain"] = output_.gain;
    result["dt_s"] = output_.dt;
    result["call"] = output_.call;
    result["status"] = kStatusNames[output_.status];
    result["contacts"] = output_.contacts;
    result["limited"] = output_.limited;
    return result;
  }

  double period() const { return hapbench_renderer_period(renderer_.get()); }
  std::string inspect() const { return hapbench_renderer_inspect(renderer_.get()); }
  std::string fault() const { return hapbench_renderer_fault(renderer_.get()); }
  std::string log_header() const {
    std::string text(hapbench_renderer_log_header(renderer_.get(), nullptr, 0) + 1, '\0');
    text.resize(hapbench_renderer_log_header(renderer_.get(), text.data(), text.size()));
    return text;
  }
  std::string log_row() const {
    std::array<char, HAPBENCH_LOG_ROW_SIZE> text{};
    return {text.data(), hapbench_renderer_log_row(&input_, &output_, text.data(), text.size())};
  }

 private:
  struct Close {
    void operator()(HapbenchRenderer* renderer) const { hapbench_renderer_close(renderer); }
  };

  std::unique_ptr<HapbenchRenderer, Close> renderer_;
  HapbenchInput input_ = {};
  HapbenchOutput output_ = {};
};

}  // namespace

void bind_renderer(py::module_& module) {
  using Mounted = std::pair<Vector, Quaternion>;
  py::class_<PythonRenderer>(module, "Renderer")
      .def(py::init<const std::string&, const std::vector<std::string>&, std::uint32_t, std::uint32_t, const Mounted&,
                    double, const Mounted&, const MountLimits&>())
      .def("step", &PythonRenderer::step)
      .def("log_header", &PythonRenderer::log_header)
      .def("log_row", &PythonRenderer::log_row)
      .def_property_readonly("period_s", &PythonRenderer::period)
      .def_property_readonly("inspection", &PythonRenderer::inspect)
      .def_property_readonly("fault", &PythonRenderer::fault);
}

}  // namespace hapbench
