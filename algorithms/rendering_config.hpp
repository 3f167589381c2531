#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "sim/contact/contact_schedule.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Parameters of the gradient-based point reduction (thesis sections C.3 and 2.8).
struct ReductionConfig {
  double threshold = 0.995;      ///< alpha_TH: gradients with a larger inner product count as similar
  std::size_t max_points = 100;  ///< n_ext: largest number of contacts kept
  /// nullopt: contacts are visited in ascending shell index. Otherwise they are visited in a fixed random order
  /// of the shell points, to study how the greedy filter depends on the order. The thesis starts at a random
  /// point.
  std::optional<std::uint64_t> shuffle_seed;
};

/// Value of RenderingConfig::contact_source: hapbench's contact search finds the contacts, and a depth model computes
/// their depths.
inline constexpr const char* kComputedContacts = "own";
/// Values of RenderingConfig::contact_source for contacts from `contact_file`. With kTrace, the file contains recorded
/// contacts of a prescribed motion. With kContactPlugin, the file is a shared library of the user that computes the
/// contacts.
inline constexpr const char* kTrace = "trace";
inline constexpr const char* kContactPlugin = "plugin";

/// Dry friction instead of the thesis's viscous friction; see stages/damping_and_limits.hpp.
struct DryFrictionConfig {
  double mu = 0.3;                  ///< friction coefficient, dimensionless
  std::optional<double> stiffness;  ///< K_t, stiffness of the bristle [N/m]; nullopt: K
  double damping_ratio = 1.0;       ///< zeta_t, damping ratio of the bristle with the virtual mass
};

// Parameters of the force stages. A force stage replaces the algorithm's force by the force to render; see
// stages/controllers.hpp.

struct EnergyTankConfig {
  double capacity = 0.1;  ///< C, largest energy that the tank keeps [J]
  double initial = 0.0;   ///< energy at the start, in addition to the energy of the springs in the first step [J]
};
struct ActuatorLimitedPassivityConfig {
  /// F, largest force of the actuators along each world axis [N]; nullopt: no limit.
  std::optional<Vec3> max_force;
  /// b, largest damping [N s/m]; nullopt: M / dt with the mass M of the virtual tool.
  std::optional<double> max_damping;
};
using ForceStageConfig = std::variant<EnergyTankConfig, ActuatorLimitedPassivityConfig>;

/// Parameters of the rendering, which computes a force from contacts. The names of the algorithms are listed by
/// algorithm_names() in registry.hpp. Units: N, m, s, kg.
struct RenderingConfig {
  std::string algorithm = "shaped_stiffness";
  int iterations = 3;  ///< m, number of shaping iterations, for laws that iterate
  std::string depth_model = "surface_normal";
  std::string contact_source = kComputedContacts;  ///< kComputedContacts, kTrace or kContactPlugin
  std::string contact_file;                        ///< file of kTrace or kContactPlugin, relative to the scenario file
  std::string contact_config = "{}";               ///< configuration for kContactPlugin: a JSON object
  std::optional<MultiRateSchedule> multi_rate;     ///< multi-rate contacts; nullopt: contacts are found in every step
  bool local_average = false;
  std::optional<ReductionConfig> reduction;

  double stiffness = 20000.0;                     ///< K, stiffness of one penalty spring [N/m]
  double damping_ratio = 0.7;                     ///< zeta, damping ratio of one spring-damper
  double mass = 0.2;                              ///< M, mass of the virtual tool [kg]
  std::optional<double> damping;                  ///< B, normal damping [N s/m]; nullopt: 2 zeta sqrt(K M)
  double mu_s = 0.0;                              ///< viscous friction [N s/m]
  double mu_f = 0.0;                              ///< viscous friction per newton of spring force [s/m]
  std::optional<DryFrictionConfig> dry_friction;  ///< replaces mu_s and mu_f; nullopt: no dry friction
  /// chi [s/m], coefficient of Hunt and Crossley's damping, which grows with the depth and replaces B; nullopt: B is
  /// used.
  std::optional<double> hunt_crossley;
  std::optional<double> max_damping;       ///< B_max, largest normal damping [N s/m]; nullopt: no limit
  std::optional<double> max_force;         ///< F_max, largest norm of the force [N]; nullopt: no limit
  std::optional<double> virtual_coupling;  ///< K_vc, stiffness of the coupling spring [N/m]; nullopt: K
  double regularisation = 0.01;            ///< eps, regularisation of the law least_squares, dimensionless

  /// Velocity that damping and friction use. true: velocity of the tool's material at each contact; false: velocity of
  /// the tip centre.
  bool angular_damping = false;
  /// Cut-off frequency of the low-pass filter of the tool's angular velocity, for `angular_damping` [Hz]; nullopt: no
  /// filter.
  std::optional<double> angular_velocity_cutoff = 20.0;

  /// Controller that replaces the algorithm's force; nullopt: no force stage.
  std::optional<ForceStageConfig> force_stage;
  bool passivity_controller = false;  ///< true: a passivity controller wraps algorithm and force stage

  /// Values of the parameters that belong to one algorithm only (AlgorithmParameter), by algorithm and name. A
  /// parameter that is missing here has its default value.
  std::map<std::string, std::map<std::string, double>> parameters;

  bool has_friction() const { return mu_s != 0.0 || mu_f != 0.0 || dry_friction; }

  /// Selects whether work that changes nothing is skipped: stages without contacts, the reduction of a single contact,
  /// friction with coefficients of zero. The contact search and the observers of a run use the same value.
  Skips skips = Skips::on;
};

/// The scenario fields that set the members of RenderingConfig, with unit and range.
namespace parameter {

inline constexpr NumberRange kSwitch = {0, 1, "1"};

inline constexpr Parameter kIterations = {"rendering.iterations", {0, 100'000, "1"}};
inline constexpr Parameter kLocalAverage = {"rendering.local_average", kSwitch};
inline constexpr Parameter kThreshold = {"rendering.reduction.threshold", {-1.0, 1.0, "1", true}};
inline constexpr Parameter kMaxPoints = {"rendering.reduction.max_points", {1, 100'000, "1"}};
inline constexpr Parameter kShuffleSeed = {"rendering.reduction.shuffle_seed", {0, 0x1p53, "1"}};
inline constexpr Parameter kStiffness = {"rendering.stiffness_N_per_m", {0.0, 1e12, "N/m"}};
inline constexpr Parameter kDampingRatio = {"rendering.damping_ratio", {0.0, 1e6, "1"}};
inline constexpr Parameter kDamping = {"rendering.damping_N_s_per_m", {0.0, 1e12, "N s/m"}};
inline constexpr Parameter kAngularDamping = {"rendering.angular_damping", kSwitch};
inline constexpr Parameter kAngularVelocityCutoff = {"rendering.angular_velocity_cutoff_Hz", {0.0, 1e6, "Hz", true}};
inline constexpr Parameter kMass = {"rendering.mass_kg", {0.0, 1e6, "kg", true}};
inline constexpr Parameter kMuS = {"rendering.friction.mu_s_N_s_per_m", {0.0, 1e9, "N s/m"}};
inline constexpr Parameter kMuF = {"rendering.friction.mu_f_s_per_m", {0.0, 1e9, "s/m"}};
inline constexpr Parameter kDryMu = {"rendering.friction.mu", {0.0, 100.0, "1"}};
inline constexpr Parameter kDryStiffness = {"rendering.friction.stiffness_N_per_m", {0.0, 1e12, "N/m", true}};
inline constexpr Parameter kDryDampingRatio = {"rendering.friction.damping_ratio", {0.0, 1e6, "1"}};
inline constexpr Parameter kChi = {"rendering.damping.chi_s_per_m", {0.0, 1e9, "s/m"}};
inline constexpr Parameter kEvery = {"rendering.contacts.every", {1, 1'000'000, "rows"}};
inline constexpr Parameter kDelay = {"rendering.contacts.delay_samples", {0, 10'000, "rows"}};
inline constexpr Parameter kDropout = {"rendering.contacts.dropout", {0.0, 1.0, "1"}};
inline constexpr Parameter kMaxDamping = {"rendering.limits.max_damping_N_s_per_m", {0.0, 1e12, "N s/m"}};
inline constexpr Parameter kMaxForce = {"rendering.limits.max_force_N", {0.0, 1e12, "N"}};
inline constexpr Parameter kVirtualCoupling = {"rendering.virtual_coupling_N_per_m", {0.0, 1e12, "N/m", true}};
/// The smallest eps is 1e-9. The rounding error of sum d_i u_i is about 1e-16 n d for n contacts of depth d. Divided by
/// a smaller eps, this error would not be much smaller than d.
inline constexpr Parameter kRegularisation = {"rendering.regularisation", {1e-9, 1e6, "1"}};
inline constexpr Parameter kTankCapacity = {"rendering.force_stage.capacity_J", {0.0, 1e6, "J"}};
inline constexpr Parameter kTankInitial = {"rendering.force_stage.initial_J", {0.0, 1e6, "J"}};
inline constexpr Parameter kActuatorForce = {"rendering.force_stage.max_force_N", {0.0, 1e12, "N"}};
inline constexpr Parameter kActuatorDamping = {"rendering.force_stage.max_damping_N_s_per_m", {0.0, 1e12, "N s/m"}};
inline constexpr Parameter kPassivityController = {"rendering.passivity_controller", kSwitch};

}  // namespace parameter

}  // namespace hapbench
