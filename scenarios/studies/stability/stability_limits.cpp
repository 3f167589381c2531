#include "scenarios/studies/stability/stability_limits.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/bisection.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// The same on eigenvalues, which cost nothing: close to rounding.
constexpr double kEigenvaluePrecision = 1e-10;
/// A probe is cut short as unstable when it has grown by this factor; a stable one swings to 1 / sqrt of its relative
/// distance to the limit, at most 1e2 at kLimitTolerance.
constexpr double kBlownUp = 1e6;
/// Steps of one probe, and how much the largest energy of the last quarter may exceed that of the quarter before. A run
/// that is unstable by a factor 1 + e per step multiplies its energy by 1 + 10 000 e, so the limit is found where e
/// passes 1e-6; a stable run repeats its largest energy much closer, because it beats in 1 / sqrt(kLimitTolerance)
/// steps or fewer.
constexpr std::int64_t kProbeSteps = 20'000;
constexpr double kLateGrowth = 1.01;
/// Energy in units of the first row's that rounding alone may leave, about a place that is not the origin.
constexpr double kRoundingEnergy = 1e-12;
constexpr int kLocusPoints = 400;
/// If time steps up to this [s] are stable, all are taken to be: multiplied by a longer one, the rounding error of a
/// velocity would pass for motion.
constexpr double kLongestStep = 1e6;

/// The value at which bisection starts, and the one beyond which it gives up.
struct Probes {
  double start, largest;
};
Probes probes_of(StabilityCase which) {
  return which == StabilityCase::time_step ? Probes{1e-9, kLongestStep} : Probes{1.0, kLargestProbe};
}

/// The springs of the scenario along a direction in which their stiffness is lambda K.
RaisedSpringDamper problem_of(StabilityCase which, const Scenario& scenario, double lambda) {
  const RenderingConfig& config = scenario.rendering;
  const SpringDamper given{.K = config.stiffness,
                           .B = 0.0,
                           .M = config.mass,
                           .dt = scenario.time.step,
                           .lambda = lambda,
                           .integrator = scenario.integrator.type};
  return {which, given, config.damping, config.damping_ratio};
}

/// Largest mechanical energy in the last two quarters of a probe: it follows growth whatever the frequency, where the
/// position alone may still be on its first swing.
class LateEnergy final : public Observer {
 public:
  /// `rest`: the place about which the tool moves.
  explicit LateEnergy(const SpringDamper& system, const Vec3& rest = Vec3::Zero())
      : stiffness_(system.lambda * system.K), mass_(system.M), rest_(rest) {}

  void on_step(const StepRecord& record) noexcept override {
    const auto quarter = record.step * 4 / static_cast<std::uint64_t>(kProbeSteps);
    const ToolState& tool = record.tool;
    const double energy = stiffness_ * (tool.pose.position - rest_).squaredNorm() + mass_ * tool.velocity.squaredNorm();
    if (record.step == 0) rounding_ = kRoundingEnergy * energy;
    if (quarter < 2) return;
    double& largest = quarter == 2 ? third_ : fourth_;
    largest = std::max(largest, energy);
  }
  bool grows() const { return fourth_ > kLateGrowth * third_ && fourth_ > rounding_; }

 private:
  double stiffness_, mass_;
  Vec3 rest_;
  double rounding_ = 0.0;
  double third_ = 0.0, fourth_ = 0.0;
};

/// Runs the scenario's own simulation with the case's numbers, from a small displacement and velocity along
/// `direction`, and sees whether it blows up.
bool simulation_stays_bounded(Scenario scenario, const SpringDamper& system, const Vec3& direction) {
  constexpr double kAmplitude = 1e-3;
  scenario.rendering.stiffness = system.K;
  scenario.rendering.damping = system.B;
  scenario.time.step = system.dt;
  scenario.time.steps = kProbeSteps;
  scenario.time.stop_when.clear();
  scenario.initial.position = kAmplitude * direction;
  scenario.initial.velocity = kAmplitude * direction;
  // Speed tells growth from drift: a mass that no spring holds goes far without going faster.
  scenario.bounds.position = kNever;
  scenario.bounds.speed = kBlownUp * kAmplitude * std::max(1.0, 1.0 / system.dt);
  scenario.bounds.force = kNever;
  LateEnergy energy(system);
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&energy});
  return run_to_end(simulation).outcome != Outcome::diverges && !energy.grows();
}

/// A tool that dry friction holds on springs that all press alike, along an axis of their S with the eigenvalue lambda:
/// the bristle's spring acts on P P, whose eigenvalue is (1 - lambda / trace S)^2.
SpringDamper stuck_mode(const Scenario& scenario, const Vec3& lambdas, double lambda) {
  const RenderingConfig& r = scenario.rendering;
  const SpringDamper bristle = bristle_of(*r.dry_friction, r, scenario.time.step);
  const double share = math::square(1.0 - lambda / lambdas.sum());
  SpringDamper mode = bristle;
  mode.K = lambda * r.stiffness + share * bristle.K;
  mode.B = lambda * normal_damping(r) + share * bristle.B;
  mode.integrator = scenario.integrator.type;
  return mode;
}

/// The tool where the scenario's springs push from one side and are all 1 m deep; none where there is no such place.
std::optional<Vec3> pressed_alike(const SpringSet& springs) {
  Eigen::MatrixX3d gradients(static_cast<Eigen::Index>(springs.gradients.size()), 3);
  for (Eigen::Index i = 0; i < gradients.rows(); ++i) gradients.row(i) = springs.gradients[static_cast<std::size_t>(i)];
  const Eigen::VectorXd depths = Eigen::VectorXd::Ones(gradients.rows());
  const Vec3 place = gradients.completeOrthogonalDecomposition().solve(depths);
  constexpr double kSameDepth = 1e-12;
  return (gradients * place - depths).norm() <= kSameDepth ? std::optional(place) : std::nullopt;
}

/// Sees in a run whether a tool that is held where all springs press alike comes to rest when it is struck: by so
/// little that their loads stay, and with a coefficient of friction that lets nothing slide.
bool stuck_tool_stays_bounded(Scenario scenario, const Vec3& place, const Mat3& S) {
  constexpr double kStrike = 1e-7;  // [m in a step]
  const double K = scenario.rendering.stiffness, dt = scenario.time.step;
  std::get<SpringsEnvironment>(scenario.environment).bilateral = false;
  scenario.rendering.dry_friction->mu = 1e6;
  ForceHandFields hand;
  const Vec3 push = K * S * place;
  for (int i = 0; i < 3; ++i) hand.force[static_cast<std::size_t>(i)] = push[i];
  scenario.hand = hand;
  scenario.time.steps = kProbeSteps;
  scenario.time.stop_when.clear();
  scenario.initial.position = place;
  scenario.initial.velocity = kStrike / dt * Vec3(0.6, 0.64, 0.48);
  scenario.bounds = {kNever, kBlownUp * kStrike / dt, kNever};
  LateEnergy energy({.K = K, .B = 0.0, .M = scenario.rendering.mass}, place);
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&energy});
  return run_to_end(simulation).outcome != Outcome::diverges && !energy.grows();
}

/// The largest K at which a tool that dry friction holds is stable, with the bristle as given.
std::optional<StabilityLimit> stuck_limit(const Scenario& given, const Mat3& S) {
  const auto place = pressed_alike(make_springs(given));
  const Vec3 lambdas = Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues();
  if (!place || !(lambdas.sum() > 0.0)) return std::nullopt;
  const auto with = [&given](double K) {
    Scenario scenario = given;
    scenario.rendering.stiffness = K;
    return scenario;
  };
  const auto modes_are_stable = [&](double K) {
    const Scenario scenario = with(K);
    return std::all_of(lambdas.begin(), lambdas.end(),
                       [&](double lambda) { return stuck_mode(scenario, lambdas, lambda).is_stable(); });
  };
  StabilityLimit limit{StabilityCase::stiffness_damped, "largest K, stuck", "N/m"};
  limit.stuck = true;
  limit.lambda = lambdas[2];
  limit.eigenvalue = largest_stable(1.0, kEigenvaluePrecision, modes_are_stable);
  limit.simulation =
      largest_stable(1.0, kLimitTolerance, [&](double K) { return stuck_tool_stays_bounded(with(K), *place, S); });
  limit.damping_at_limit = normal_damping(with(limit.eigenvalue).rendering);
  return limit;
}

/// Keeps the stiffness tensor of the last row.
class LastTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override { S = record.force.S; }
  Mat3 S = Mat3::Zero();
};

[[noreturn]] void fail(const char* place, const char* problem) {
  throw InputError(InputError::Kind::relation, place, problem);
}

}  // namespace

Mat3 stiffness_tensor_of(Scenario scenario) {
  scenario.time.steps = 1;
  scenario.bounds = {};
  scenario.initial.position = Vec3(1e-3, 1e-3, 1e-3);
  LastTensor tensor;
  Simulation(simulation_config(scenario), assemble(scenario), {&tensor}).run();
  return tensor.S;
}

SpringDamper tool_on_spring(const Scenario& scenario, double lambda) {
  const RenderingConfig& r = scenario.rendering;
  return {r.stiffness, normal_damping(r), r.mass, scenario.time.step, lambda, scenario.integrator.type};
}

void require_bilateral_springs(const Scenario& scenario) {
  const auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  if (springs == nullptr)
    fail("/environment/type", "stability limits exist for \"springs\" only: elsewhere contacts come and go");
  if (!springs->bilateral) fail("/environment/bilateral", "got false; allowed for stability: true");
  if (!springs->signed_depths) fail("/environment/signed", "got false; allowed for stability: true");
  if (scenario.rendering.has_friction()) fail("/rendering/friction", "allowed for stability: none");
  if (scenario.rendering.hunt_crossley) fail("/rendering/damping", "allowed for stability: null");
  if (scenario.rendering.late && scenario.rendering.late->any())
    fail("/rendering/contacts", "allowed for stability: null");
  if (scenario.rendering.max_damping) fail("/rendering/limits/max_damping_N_s_per_m", "allowed for stability: null");
  if (scenario.rendering.max_force) fail("/rendering/limits/max_force_N", "allowed for stability: null");
  if (!std::holds_alternative<FreePosition>(scenario.motion.position))
    fail("/motion/position/type", "allowed for stability: \"free\"");
  if (scenario.rendering.force_stage) fail("/rendering/force_stage", "allowed for stability: null");
  if (scenario.rendering.passivity_controller)
    fail("/rendering/passivity_controller", "got true; allowed for stability: false");
}

void require_lasting_springs(const Scenario& scenario) {
  require_bilateral_springs(scenario);
  if (!std::holds_alternative<NoHandFields>(scenario.hand)) fail("/hand/type", "allowed for stability: \"none\"");
  if (handle_moves_tool(scenario.device))
    fail("/device/type", "got \"impedance\", which has no virtual mass; allowed for stability: \"ideal\"");
}

std::optional<double> analytic_limit(StabilityCase which, const Scenario& scenario, double lambda) {
  const auto limit = scenario.integrator.type->stability_limit;
  return limit == nullptr ? std::nullopt : limit(problem_of(which, scenario, lambda));
}

double eigenvalue_limit(StabilityCase which, const Scenario& scenario, double lambda, double start) {
  const RaisedSpringDamper problem = problem_of(which, scenario, lambda);
  const auto stable = [&](double value) { return problem.at(value).is_stable(); };
  return largest_stable(start, kEigenvaluePrecision, stable, probes_of(which).largest);
}

std::vector<StabilityLimit> stability_limits(const Scenario& given) {
  Scenario scenario = given;
  scenario.rendering.dry_friction.reset();  // springs that pull have no load
  require_lasting_springs(scenario);
  const Eigen::SelfAdjointEigenSolver<Mat3> S(stiffness_tensor_of(scenario));
  const double lambda = S.eigenvalues()[2];
  const Vec3 stiffest = S.eigenvectors().col(2);

  std::vector<StabilityLimit> limits = {
      {StabilityCase::stiffness_undamped, "largest K, B = 0", "N/m"},
      {StabilityCase::damping_alone, "largest B, K = 0", "N s/m"},
      {StabilityCase::stiffness_damped, "largest K, B from zeta", "N/m"},
      {StabilityCase::time_step, "largest time step", "s"},
  };
  for (StabilityLimit& limit : limits) {
    const RaisedSpringDamper problem = problem_of(limit.which, scenario, lambda);
    limit.lambda = lambda;
    limit.analytic = analytic_limit(limit.which, scenario, lambda);
    const Probes probes = probes_of(limit.which);
    limit.eigenvalue = eigenvalue_limit(limit.which, scenario, lambda, probes.start);
    limit.damping_at_limit = problem.at(limit.limit()).B;
    const auto run = [&](double value) { return simulation_stays_bounded(scenario, problem.at(value), stiffest); };
    limit.simulation = largest_stable(probes.start, kLimitTolerance, run, probes.largest);
  }
  if (given.rendering.dry_friction) {
    if (auto stuck = stuck_limit(given, stiffness_tensor_of(scenario))) limits.push_back(std::move(*stuck));
  }
  return limits;
}

std::vector<RootLocusPoint> root_locus(const Scenario& scenario, const std::vector<StabilityLimit>& limits) {
  std::vector<RootLocusPoint> locus;
  for (const StabilityLimit& limit : limits) {
    if (limit.stuck || !std::isfinite(limit.limit())) continue;
    const RaisedSpringDamper problem = problem_of(limit.which, scenario, limit.lambda);
    for (int i = 0; i <= kLocusPoints; ++i) {
      const double value = 1.25 * limit.limit() * i / kLocusPoints;
      if (value == 0.0 && limit.which == StabilityCase::time_step) continue;
      const auto [first, second] = problem.at(value).eigenvalues();
      locus.push_back({limit.which, value, first, second});
    }
  }
  return locus;
}

namespace {

/// A hand whose force does not depend on the handle.
bool is_blind(const HandFields& hand) {
  return std::holds_alternative<NoHandFields>(hand) || std::holds_alternative<ForceHandFields>(hand) ||
         std::holds_alternative<PushHandFields>(hand);
}

DeviceLoop impedance_loop(const Scenario& scenario, const ImpedanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  SampledLoop& loop = result.loop.emplace<SampledLoop>();
  loop.device = device;
  loop.period = scenario.time.step;
  loop.stiffness = lambda * scenario.rendering.stiffness;
  loop.wall_damping = lambda * normal_damping(scenario.rendering);
  if (const auto* hand = std::get_if<MassSpringDamperHandFields>(&scenario.hand))
    loop.hand = {hand->mass, hand->spring.stiffness, hand->spring.damping};
  else if (!is_blind(scenario.hand))
    result.no_theory = "the hand's force is sampled";
  if (const char* nonlinearity = loop.nonlinearity()) result.no_theory = nonlinearity;
  return result;
}

DeviceLoop admittance_loop(const Scenario& scenario, const AdmittanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  AdmittanceLoop& loop = result.loop.emplace<AdmittanceLoop>();
  loop.tool = tool_on_spring(scenario, lambda);
  loop.servo = device.servo;
  loop.mechanics = device.mechanics;
  if (const auto* hand = std::get_if<ImpedanceHandFields>(&scenario.hand)) {
    loop.hand_stiffness = hand->stiffness;
    loop.hand_damping = hand->damping;
  } else if (!is_blind(scenario.hand)) {
    result.no_theory = "the hand is no spring and damper";
  }
  return result;
}

/// The fields of devices that their loops have, that SampledLoop::nonlinearity names, or that do nothing while nothing
/// saturates, with a blank before and after each. Any other that is not at its default leaves no theory.
constexpr std::string_view kKnownToTheory =
    " /handle_mass_kg /viscous_N_s_per_m /coulomb_N /encoder_step_m /delay_samples /force_max_N /force_step_N "
    "/force_slew_N_per_s /position_noise_m /velocity_filter/noise_m /velocity_filter/cutoff_Hz /velocity_filter/order "
    "/position_filter/cutoff_Hz /position_filter/order /transmission/motor_share /transmission/stiffness_N_per_m "
    "/transmission/damping_N_s_per_m /force_limit_N /sensor/weight_offset_N /sensor/weight_compensated /sensor/noise_N "
    "/servo/stiffness_N_per_m /servo/damping_N_s_per_m /servo/max_force_N /servo/delay_samples "
    "/mechanics/carriage_mass_kg /mechanics/handle_mass_kg /mechanics/friction_N_s_per_m "
    "/mechanics/structure_stiffness_N_per_m /mechanics/structure_damping_N_s_per_m ";

/// Eigenvalues of larger matrices take seconds.
constexpr double kLongestDelay = 200.0;

}  // namespace

Scenario stuck_scene(Scenario scenario) {
  RenderingConfig& r = scenario.rendering;
  const SpringDamper bristle = bristle_of(*r.dry_friction, r, scenario.time.step);
  r.stiffness = bristle.K;
  r.damping = bristle.B;
  if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    const auto* filter = std::get_if<LowPassFilter>(&device->velocity_filter);
    device->position_filter = filter != nullptr ? std::optional(*filter) : std::nullopt;
  }
  return scenario;
}

double delay_of(const Scenario& scenario) {
  if (const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) return impedance->delay_samples;
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  return admittance != nullptr ? static_cast<double>(admittance->servo.delay) : 0.0;
}

std::string unknown_to_theory(const Scenario& scenario) {
  // With the parts of the device, so that only fields of theirs can differ.
  DeviceFields plain = AdmittanceDeviceConfig{};
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    auto& parts = plain.emplace<ImpedanceDeviceConfig>();
    if (std::holds_alternative<LowPassFilter>(device->velocity_filter)) parts.velocity_filter = LowPassFilter{};
    if (std::holds_alternative<AdaptiveWindowFilter>(device->velocity_filter))
      parts.velocity_filter = AdaptiveWindowFilter{};
    if (device->position_filter) parts.position_filter.emplace();
    if (device->transmission) parts.transmission.emplace();
  }
  std::string unknown;
  for (const Json& change : Json::diff(written(plain), written(scenario.device))) {
    const std::string path = change["path"].get<std::string>();
    if (kKnownToTheory.find(" " + path + " ") == std::string_view::npos)
      unknown += (unknown.empty() ? "device" : ", device") + path;
  }
  std::replace(unknown.begin(), unknown.end(), '/', '.');
  return unknown;
}

DeviceLoop device_loop(const Scenario& scenario, double lambda) {
  const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  DeviceLoop result = impedance != nullptr ? impedance_loop(scenario, *impedance, lambda)
                                           : admittance_loop(scenario, *admittance, lambda);
  if (delay_of(scenario) > kLongestDelay)
    result.no_theory = "a delay beyond 200 samples makes the loop too large to solve";
  if (const std::string unknown = unknown_to_theory(scenario); !unknown.empty())
    result.no_theory = unknown + ": not in the theory of the loop";
  return result;
}

Eigen::MatrixXd contact_step(const Scenario& scenario, double lambda) {
  if (std::holds_alternative<IdealDeviceFields>(scenario.device)) return tool_on_spring(scenario, lambda).step_matrix();
  if (delay_of(scenario) > kLongestDelay || !unknown_to_theory(scenario).empty()) return {};
  return device_loop(scenario, lambda).state_matrix();
}

}  // namespace hapbench
