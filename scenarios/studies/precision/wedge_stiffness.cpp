#include "scenarios/studies/precision/wedge_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

/// S = n (u1 u1^T + u2 u2^T).
WedgeStiffness sum(const RenderingConfig&, double w, double n) {
  return {2.0 * n * std::pow(std::sin(w), 2), 2.0 * n * std::pow(std::cos(w), 2)};
}

WedgeStiffness mean(const RenderingConfig&, double w, double) {
  return {std::pow(std::sin(w), 2), std::pow(std::cos(w), 2)};
}

/// The sum in series with K_vc, along each axis by itself.
WedgeStiffness coupled(const RenderingConfig& config, double w, double n) {
  const double k = config.virtual_coupling.value_or(config.stiffness) / config.stiffness;
  const auto in_series = [k](double x) { return k * x / (k + x); };
  const auto [along, across] = sum(config, w, n);
  return {in_series(along), in_series(across)};
}

/// The weights of a face add up to 1 / (1 + <u1, u2>^2), from the first update on.
WedgeStiffness shaped(const RenderingConfig& config, double w, double n) {
  if (config.iterations == 0) return sum(config, w, n);
  const double weight = 1.0 / (1.0 + std::pow(std::cos(2.0 * w), 2));
  return {2.0 * weight * std::pow(std::sin(w), 2), 2.0 * weight * std::pow(std::cos(w), 2)};
}

/// The limit of the iteration, whatever its number; epsilon = 1e-6 of it apart.
WedgeStiffness exactly_shaped(const RenderingConfig&, double w, double n) {
  RenderingConfig converged;
  converged.iterations = 1;
  return shaped(converged, w, n);
}

/// S = u_r u_r^T, and the mean gradient u_r points straight in.
WedgeStiffness averaged(const RenderingConfig&, double, double) {
  return {1.0, 0.0};
}

/// The projector onto the plane that the two gradients span.
WedgeStiffness held(const RenderingConfig&, double, double) {
  return {1.0, 1.0};
}

struct ClosedForm {
  std::string_view algorithm;
  WedgeStiffness (*stiffness)(const RenderingConfig& config, double w, double n);
};

constexpr ClosedForm kClosedForms[] = {
    {"original_averaging", averaged},
    {"summation", sum},
    {"mean", mean},
    {"virtual_coupling", coupled},
    {"shaped_stiffness", shaped},
    {"tandpasta", sum},             // all springs fight alike, and sigma_E undoes that
    {"normal_projection", shaped},  // springs give the depths
    {"continuous_normal_projection", shaped},
    {"exact_shaping", exactly_shaped},
    {"merged_shaping", exactly_shaped},  // a group for each face
    {"proxy", held},
};

}  // namespace

std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle,
                                              double points_per_face) {
  const auto form = std::find_if(std::begin(kClosedForms), std::end(kClosedForms),
                                 [&config](const ClosedForm& f) { return f.algorithm == config.algorithm; });
  if (form == std::end(kClosedForms) || config.stiffness == 0.0) return std::nullopt;
  return form->stiffness(config, half_angle, points_per_face);
}

Scenario with_wedge(Scenario scenario, double half_angle) {
  auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  const bool two_faces = springs != nullptr && springs->random.count == 0 && springs->groups.size() == 2 &&
                         springs->groups[0].count > 0 && springs->groups[0].count == springs->groups[1].count;
  if (!two_faces) {
    throw InputError(InputError::Kind::relation, "/environment",
                     "got no wedge; allowed for this study: springs in two groups of the same count");
  }
  const double c = std::cos(half_angle), s = std::sin(half_angle);
  springs->groups[0].direction = {c, -s, 0.0};
  springs->groups[1].direction = {-c, -s, 0.0};
  return scenario;
}

}  // namespace hapbench
