#include "scenarios/program/linear_loop_request.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>

#include "device_model/impedance_device.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/chosen_devices.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/option_values.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Returns a number as JSON; null if it is infinite.
Json finite_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json();
}

/// Returns the loop of the device, without a hand, in a scene in which the handle always touches the virtual wall.
/// Throws InputError for an invalid number and for a device that the linear theory does not cover.
SampledLoop loop_at_wall(const ComparedDevice& device, double period, double stiffness, double damping, double delay) {
  const ScenarioText scene = read_scenario_text(installed_folder("scenarios/library/limits") / "wall_on_handle.json");
  LoadedScenario loaded = load_scenario(scene, overrides_on(device, scene,
                                                            {fmt::format("time.step_s={}", period),
                                                             fmt::format("rendering.stiffness_N_per_m={}", stiffness),
                                                             fmt::format("rendering.damping_N_s_per_m={}", damping)}));
  auto* impedance = std::get_if<ImpedanceDeviceConfig>(&loaded.scenario.device);
  if (impedance == nullptr)
    throw InputError(
        fmt::format("--device: got \"{}\"; allowed: an impedance device, whose stiffness limit the linear "
                    "theory gives (\"hapbench describe presets\")",
                    device.name));
  impedance->delay_samples += delay / period;
  const std::string unmodelled = unmodelled_fields(loaded.scenario);
  if (!unmodelled.empty() || impedance->delay_samples > kMaxLoopDelay)
    throw InputError(fmt::format("--device: {}: {}", device.name,
                                 unmodelled.empty()
                                     ? "the delay is longer than 200 samples, too long for the eigenvalue computation"
                                     : unmodelled + ": not part of the linear theory"));
  return std::get<SampledLoop>(device_loop(loaded.scenario, 1.0).loop);
}

/// Returns frequency [Hz] and growth [1/s] of the slowest-decaying oscillation of the loop; null without oscillation.
Json oscillation(const SampledLoop& loop) {
  const Eigen::VectorXcd values = eigenvalues(loop.state_matrix());
  const std::complex<double>* slowest = nullptr;
  for (const std::complex<double>& value : values)
    if (value.imag() != 0.0 && (slowest == nullptr || std::norm(value) > std::norm(*slowest))) slowest = &value;
  if (slowest == nullptr) return {};
  return {{"frequency_Hz",
           std::abs(math::atan2(slowest->imag(), slowest->real())) / (2.0 * std::numbers::pi * loop.period)},
          {"growth_per_s", 0.5 * math::log(std::norm(*slowest)) / loop.period}};
}

}  // namespace

int print_linear_loop(const ProgramArguments& given, ProgramContext& context) {
  if (given.size() != 6 || given[0] != kLinearLoop)
    throw InputError("audit: --linear-loop: allowed: DEVICE PERIOD STIFFNESS DAMPING DELAY");
  const double period = parse_bounded_number("period", given[2], 1e-6, 1.0),
               stiffness = parse_bounded_number("stiffness", given[3], 1e-6, 1e9),
               damping = parse_bounded_number("damping", given[4], 0.0, 1e6),
               delay = parse_bounded_number("delay", given[5], 0.0, 1e3);
  const std::vector<ComparedDevice> devices = chosen_devices({given[1]});
  if (devices.size() != 1)
    throw InputError(fmt::format("--device: got \"{}\"; allowed: one device, a preset or FILE.json", given[1]));

  SampledLoop loop = loop_at_wall(devices[0], period, stiffness, damping, delay);
  const double limit = linear_stability_limit(loop);
  Json answer = {{"device", devices[0].name},
                 {"linear_limit_N_per_m", finite_or_null(limit)},
                 {"worst_hand_limit_N_per_m", finite_or_null(worst_hand_stability_limit(loop))},
                 {"published_N_per_m", devices[0].published_stiffness ? Json(*devices[0].published_stiffness) : Json()},
                 {"at_stiffness", oscillation(loop)},
                 {"delay_samples", loop.device.delay_samples},
                 {"handle_mass_kg", loop.device.handle_mass},
                 {"viscous_N_s_per_m", loop.device.viscous},
                 {"coulomb_N", loop.device.coulomb},
                 {"encoder_step_m", loop.device.encoder_step}};
  loop.stiffness = limit;
  answer["at_limit"] = std::isfinite(limit) && limit > 0.0 ? oscillation(loop) : Json();
  print(context, {}, answer.dump() + "\n", answer);
  return kSuccess;
}

}  // namespace hapbench
