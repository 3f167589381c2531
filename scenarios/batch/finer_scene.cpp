#include "scenarios/batch/finer_scene.hpp"

#include <fmt/format.h>

#include <cmath>

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

FinerScene with_finer_step(const Scenario& scenario, int times) {
  const TimeFields& time = scenario.time;
  FinerScene finer{{fmt::format("time.step_s={}", time.step / times), fmt::format("time.steps={}", times * time.steps)},
                   times};
  const auto keep_delay = [&finer, times](const char* field, auto steps) {
    if (steps > 0) finer.overrides.push_back(fmt::format("{}={}", field, static_cast<decltype(steps)>(times) * steps));
  };
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device))
    keep_delay("device.delay_samples", device->delay_samples);
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device))
    keep_delay("device.servo.delay_samples", device->servo.delay);
  return finer;
}

}  // namespace hapbench
