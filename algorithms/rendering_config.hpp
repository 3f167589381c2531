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

/// Gradient-based point reduction (thesis C.3, 2.8).
struct ReductionConfig {
  double threshold = 0.995;      ///< alpha_TH: gradients with a larger inner product are similar
  std::size_t max_points = 100;  ///< n_ext
  /// Without a seed, contacts are visited in ascending shell index. With one, in a fixed random order of the shell
  /// points, to study how the greedy filter depends on it (the thesis starts at a random point).
  std::optional<std::uint64_t> shuffle_seed;
};

/// The value of RenderingConfig::contact_source for the contacts of our search and depth models.
inline constexpr const char* kOwnContacts = "own";
/// Contacts that a file gives: the recorded contacts of a prescribed motion, or a library of the user's own.
inline constexpr const char* kTrace = "trace";
inline constexpr const char* kContactPlugin = "plugin";

/// Dry friction in place of the thesis's viscous one; see stages/damping_and_limits.hpp.
struct DryFrictionConfig {
  double mu = 0.3;                  ///< friction coefficient [1]
  std::optional<double> stiffness;  ///< K_t of the bristle [N/m]; none: K
  double damping_ratio = 1.0;       ///< zeta_t of the bristle with the virtual mass
};

// Force stages, which see the force of the algorithm and answer the one to render; see stages/controllers.hpp.

struct EnergyTankConfig {
  double capacity = 0.1;  ///< C [J]
  double initial = 0.0;   ///< besides the energy of the springs in the first row [J]
};
struct ActuatorLimitedPassivityConfig {
  std::optional<Vec3> max_force;      ///< F of the actuator along each axis [N]; none: no limit
  std::optional<double> max_damping;  ///< b [N s/m]; none: M / dt of the virtual tool
};
using ForceStageConfig = std::variant<EnergyTankConfig, ActuatorLimitedPassivityConfig>;

/// Parameters of the rendering: how contacts become a force. Names are those of registry.hpp. Units: N, m, s, kg.
struct RenderingConfig {
  std::string algorithm = "shaped_stiffness";
  int iterations = 3;  ///< m of the shaping iteration, for the laws that iterate
  std::string depth_model = "surface_normal";
  std::string contact_source = kOwnContacts;  ///< or kTrace, kContactPlugin
  std::string contact_file;                   ///< of the latter two, relative to the scenario file
  std::string contact_config = "{}";          ///< of kContactPlugin: a JSON object
  std::optional<Lateness> late;               ///< none: contacts of every row
  bool local_average = false;
  std::optional<ReductionConfig> reduction;

  double stiffness = 20000.0;                     ///< K [N/m]
  double damping_ratio = 0.7;                     ///< zeta
  double mass = 0.2;                              ///< M of the virtual tool [kg]
  std::optional<double> damping;                  ///< B [N s/m]; none: 2 zeta sqrt(K M)
  double mu_s = 0.0;                              ///< viscous friction [N s/m]
  double mu_f = 0.0;                              ///< viscous friction per newton of spring force [s/m]
  std::optional<DryFrictionConfig> dry_friction;  ///< then mu_s and mu_f are 0
  /// chi [s/m] of damping that grows with depth (Hunt and Crossley), in place of B.
  std::optional<double> hunt_crossley;
  std::optional<double> max_damping;       ///< B_max [N s/m]
  std::optional<double> max_force;         ///< F_max [N]
  std::optional<double> virtual_coupling;  ///< K_vc [N/m]; none: K
  double regularisation = 0.01;            ///< eps of least_squares

  bool angular_damping = false;  ///< damping and friction act on the velocity of the tool at each contact
  std::optional<double> angular_velocity_cutoff = 20.0;  ///< low-pass of that angular velocity [Hz]

  std::optional<ForceStageConfig> force_stage;  ///< behind the algorithm; none: its force is rendered
  bool passivity_controller = false;            ///< around both

  /// Given values of parameters that belong to one algorithm alone (OwnParameter), by algorithm and name.
  std::map<std::string, std::map<std::string, double>> parameters;

  bool has_friction() const { return mu_s != 0.0 || mu_f != 0.0 || dry_friction; }

  /// Skipped: stages without contacts, the reduction of one contact, friction with coefficients of zero. The run uses
  /// the same value for its search and its records.
  Skips skips = Skips::on;
};

/// The fields of a scenario that set these, with unit and range.
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
/// Below 1e-9, the rounding of sum d_i u_i (1e-16 n d) divided by eps would not be far below a depth.
inline constexpr Parameter kRegularisation = {"rendering.regularisation", {1e-9, 1e6, "1"}};
inline constexpr Parameter kTankCapacity = {"rendering.force_stage.capacity_J", {0.0, 1e6, "J"}};
inline constexpr Parameter kTankInitial = {"rendering.force_stage.initial_J", {0.0, 1e6, "J"}};
inline constexpr Parameter kActuatorForce = {"rendering.force_stage.max_force_N", {0.0, 1e12, "N"}};
inline constexpr Parameter kActuatorDamping = {"rendering.force_stage.max_damping_N_s_per_m", {0.0, 1e12, "N s/m"}};
inline constexpr Parameter kPassivityController = {"rendering.passivity_controller", kSwitch};

}  // namespace parameter

}  // namespace hapbench
