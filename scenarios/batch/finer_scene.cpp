#include "scenarios/batch/finer_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scenarios/run/scene_facts.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {
namespace {

struct PointDistanceOf {
  const NamedFiles& files;

  std::optional<PointDistance> operator()(const SpringsEnvironment&) const { return std::nullopt; }
  std::optional<PointDistance> operator()(const PointShellEnvironment&) const { return std::nullopt; }
  std::optional<PointDistance> operator()(const BlockEnvironment& block) const {
    return {{"environment.grid_m", block.grid}};
  }
  std::optional<PointDistance> operator()(const MeshEnvironment& mesh) const {
    if (mesh.spacing) return {{"environment.spacing_m", *mesh.spacing}};
    const TriangleSoup soup = files.at(kEnvironmentFile).mesh().triangles();
    double area = 0.0;
    for (const auto& [a, b, c] : soup.triangles) {
      const Vec3& corner = soup.vertices[a];
      area += 0.5 * (soup.vertices[b] - corner).cross(soup.vertices[c] - corner).norm();
    }
    return {{"environment.spacing_m", std::sqrt(area / static_cast<double>(soup.vertices.size())), false}};
  }
  template <class Analytic>
  std::optional<PointDistance> operator()(const Analytic& shape) const {
    if constexpr (requires { shape.spacing; }) {
      return {{"environment.spacing_m", shape.spacing}};
    } else {
      return std::nullopt;
    }
  }
};

}  // namespace

std::optional<PointDistance> point_distance(const LoadedScenario& loaded) {
  return std::visit(PointDistanceOf{loaded.files}, loaded.scenario.environment);
}

FinerScene with_finer_spacing(const LoadedScenario& loaded, int times) {
  if (std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment)) return {{}, "springs have no points"};
  const auto distance = point_distance(loaded);
  if (!distance) return {{}, "no field sets the distance of the environment's points; only a finer file could tell"};
  const double finer = distance->metres / times;
  return {{fmt::format("{}={}", distance->path, finer)},
          fmt::format("{} {}{} -> {}", distance->path, distance->is_given ? "" : "none, about ",
                      length_text(distance->metres), length_text(finer))};
}

FinerScene with_finer_step(const Scenario& scenario, int times) {
  const TimeFields& time = scenario.time;
  const double step = time.step / times;
  FinerScene finer{{fmt::format("time.step_s={}", step), fmt::format("time.steps={}", times * time.steps)},
                   fmt::format("time.step_s {:.3g} -> {:.3g} ms", 1e3 * time.step, 1e3 * step)};
  const auto keep_delay = [&finer, times](const char* field, auto steps) {
    if (!(steps > 0)) return;
    const auto more = static_cast<decltype(steps)>(times) * steps;
    finer.overrides.push_back(fmt::format("{}={}", field, more));
    finer.change += fmt::format(", {} {} -> {}", field, steps, more);
  };
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device))
    keep_delay("device.delay_samples", device->delay_samples);
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device))
    keep_delay("device.servo.delay_samples", device->servo.delay);
  if (!std::holds_alternative<FreePosition>(scenario.motion.position))
    finer.change += "; the motion is prescribed, so that only laws with a memory notice";
  return finer;
}

}  // namespace hapbench
