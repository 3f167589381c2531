#pragma once

#include "sim/core/model_info.hpp"

namespace hapbench {

/// Parameters of the rendering, for the documentation of models and the description of scenarios. The defaults are
/// those of the members of RenderingConfig.
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
