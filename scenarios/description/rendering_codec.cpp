#include "scenarios/description/rendering_codec.hpp"

#include "algorithms/registry.hpp"
#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

template <class Table>
std::vector<std::string> names(const Table& table) {
  std::vector<std::string> names;
  for (const auto& entry : table) names.emplace_back(entry.info->name);
  return names;
}

CodecPtr<std::optional<ReductionConfig>> reduction_codec() {
  auto reduction = object<ReductionConfig>();
  reduction->optional(
      "threshold", [](auto& r) -> double& { return r.threshold; }, number({-1.0, 1.0, "1", true}),
      "alpha_TH: gradients with a larger inner product are similar");
  reduction->optional(
      "max_points", [](auto& r) -> std::size_t& { return r.max_points; }, integer_as<std::size_t>(1, 100'000),
      "n_ext: most points kept");
  reduction->optional(
      "shuffle_seed", [](auto& r) -> auto& { return r.shuffle_seed; },
      nullable(integer_as<std::uint64_t>(0, std::int64_t{1} << 53)),
      "visit the points in a fixed random order; null: ascending index");
  return nullable(CodecPtr<ReductionConfig>(reduction));
}

std::shared_ptr<ObjectCodec<RenderingFields>> friction_codec() {
  auto friction = object<RenderingFields>();
  friction->deferred(
      "mu_s_N_s_per_m", [](auto& r) -> auto& { return r.mu_s; }, number({0.0, 1e9, "N s/m"}),
      "viscous friction; default 0 for springs, else 5");
  friction->deferred(
      "mu_f_s_per_m", [](auto& r) -> auto& { return r.mu_f; }, number({0.0, 1e9, "s/m"}),
      "viscous friction per newton of spring force; default 0 for springs, else 10");
  return friction;
}

std::shared_ptr<ObjectCodec<RenderingConfig>> limits_codec() {
  auto limits = object<RenderingConfig>();
  limits->optional(
      "max_damping_N_s_per_m", [](auto& r) -> auto& { return r.max_damping; }, nullable(number({0.0, 1e12, "N s/m"})),
      "B_max; null: off");
  limits->optional(
      "max_force_N", [](auto& r) -> auto& { return r.max_force; }, nullable(number({0.0, 1e12, "N"})),
      "F_max; null: off");
  return limits;
}

}  // namespace

CodecPtr<RenderingFields> rendering_codec() {
  auto rendering = object<RenderingFields>();
  rendering->optional(
      "algorithm", [](auto& r) -> std::string& { return r.config.algorithm; },
      name_of(names(algorithms()), "algorithm"), "force algorithm");
  rendering->optional(
      "iterations", [](auto& r) -> int& { return r.config.iterations; }, integer_as<int>(0, 100'000),
      "m of the shaping iteration");
  rendering->deferred(
      "depth_model", [](auto& r) -> auto& { return r.depth_model; }, name_of(names(depth_models()), "depth model"),
      "default surface_normal, or what the algorithm's definition fixes");
  rendering->optional(
      "local_average", [](auto& r) -> bool& { return r.config.local_average; }, boolean(),
      "merge colliding points that share a grid cell of the shell");
  rendering->deferred(
      "reduction", [](auto& r) -> auto& { return r.reduction; }, reduction_codec(),
      "gradient-based reduction; null: off; default on in 3-D scenes, off in planar ones");
  rendering->optional(
      "stiffness_N_per_m", [](auto& r) -> double& { return r.config.stiffness; }, number({0.0, 1e12, "N/m"}), "K");
  rendering->optional(
      "damping_ratio", [](auto& r) -> double& { return r.config.damping_ratio; }, number({0.0, 1e6, "1"}),
      "zeta; B = 2 zeta sqrt(K M)");
  rendering->optional(
      "damping_N_s_per_m", [](auto& r) -> auto& { return r.config.damping; }, nullable(number({0.0, 1e12, "N s/m"})),
      "B instead of the one from zeta; null: from zeta");
  rendering->optional(
      "angular_damping", [](auto& r) -> bool& { return r.config.angular_damping; }, boolean(),
      "damping and friction see the velocity of the tool's material at each contact, not only the tip centre's");
  rendering->optional(
      "angular_velocity_cutoff_Hz", [](auto& r) -> auto& { return r.config.angular_velocity_cutoff; },
      nullable(number({0.0, 1e6, "Hz", true})),
      "first-order low-pass of the angular velocity that angular_damping sees; null: none");
  rendering->deferred(
      "mass_kg", [](auto& r) -> auto& { return r.mass; }, number({0.0, 1e6, "kg", true}),
      "M of the virtual tool; default 0.2 in planar scenes, else 0.1");
  rendering->optional(
      "friction", [](auto& r) -> RenderingFields& { return r; }, CodecPtr<RenderingFields>(friction_codec()),
      "tangential damping");
  rendering->optional(
      "limits", [](auto& r) -> RenderingConfig& { return r.config; }, CodecPtr<RenderingConfig>(limits_codec()),
      "optional limits");
  rendering->optional(
      "virtual_coupling_N_per_m", [](auto& r) -> auto& { return r.config.virtual_coupling; },
      nullable(number({0.0, 1e12, "N/m", true})), "K_vc of algorithm virtual_coupling; null: K");
  rendering->optional(
      "passivity_controller", [](auto& r) -> bool& { return r.config.passivity_controller; }, boolean(),
      "adaptive damping that lets the algorithm create no energy");
  return rendering;
}

}  // namespace hapbench
