#include "algorithms/registry.hpp"
#include "algorithms/laws/exact_shaping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::registry_test {
namespace {

/// Checks that each algorithm is found by its name, which implies that no two algorithms have the same name. Also
/// checks that each algorithm can be built and that its fixed depth model exists.
TEST(Registry, EveryListedNameIsFoundAndBuilds) {
  for (const AlgorithmEntry& entry : algorithms()) {
    EXPECT_EQ(find_algorithm(entry.info->name), &entry);
    RenderingConfig config;
    config.algorithm = entry.info->name;
    EXPECT_NE(make_algorithm(config), nullptr) << entry.info->name;
    EXPECT_TRUE(entry.fixed_depth_model.empty() || find_depth_model(entry.fixed_depth_model) != nullptr);
  }
  for (const DepthModelEntry& entry : depth_models()) {
    EXPECT_EQ(find_depth_model(entry.info->name), &entry);
    EXPECT_NE(entry.make(), nullptr) << entry.info->name;
  }
}

TEST(Registry, EveryModelDocumentsItself) {
  std::vector<const ModelInfo*> models(stages().begin(), stages().end());
  for (const AlgorithmEntry& entry : algorithms()) models.push_back(entry.info);
  for (const DepthModelEntry& entry : depth_models()) models.push_back(entry.info);
  for (const ModelInfo* model : models) {
    for (const char* text : {model->name, model->summary, model->formula, model->source, model->known_failure}) {
      ASSERT_NE(text, nullptr);
      EXPECT_FALSE(std::string(text).empty()) << model->name;
    }
    for (const ParameterInfo& parameter : model->parameters) {
      const auto& [field, range] = parameter.parameter;
      for (const char* text : {field, range.unit, parameter.meaning}) {
        ASSERT_NE(text, nullptr);
        EXPECT_FALSE(std::string(text).empty()) << model->name;
      }
      EXPECT_EQ(std::string(field).rfind("rendering.", 0), 0u) << field;
      EXPECT_LT(range.min, range.max) << field;
    }
  }
}

TEST(Registry, EveryForceBoundHoldsForASingleSpring) {
  for (const AlgorithmEntry& entry : algorithms()) {
    const auto bound = entry.force_bound;
    if (bound == nullptr) continue;
    RenderingConfig config;
    config.algorithm = entry.info->name;
    test::Setting setting;
    setting.springs = SpringSet{{Vec3::UnitX()}, true};
    setting.pose.position = {1e-4, 0.0, 0.0};
    const RenderedForce force = test::Probe(setting, config).force_at(setting.pose);
    const double largest = config.stiffness * bound(config, setting.tool, 1, force.depth_max);
    EXPECT_GT(force.spring.norm(), 0.0) << entry.info->name;
    EXPECT_LE(force.spring.norm(), largest * (1.0 + 1e-12)) << entry.info->name;
  }
}

/// Stiffness in a wedge, in units of K, along two axes of the tensor. w is the angle between each face and the middle
/// plane of the wedge [rad], 0 < w < pi/2. +y points out of the wedge, and x points from one face to the other. The
/// contact gradients (+-cos w, -sin w, 0) have the inner product -cos 2w.
struct WedgeStiffness {
  double along;   ///< stiffness along the direction out of the wedge
  double across;  ///< stiffness from face to face
};

/// Returns the stiffness if the weights of each face sum to `weight`: S = weight (u1 u1^T + u2 u2^T).
WedgeStiffness of_weight(double w, double weight) {
  return {2.0 * weight * std::pow(std::sin(w), 2), 2.0 * weight * std::pow(std::cos(w), 2)};
}

/// Returns the stiffness of the faces in series with springs of the stiffness `added`: s / (added + s), where s is the
/// summed stiffness along the axis.
WedgeStiffness in_series(double w, double n, double added) {
  const auto [along, across] = of_weight(w, n);
  return {along / (added + along), across / (added + across)};
}

/// Returns the stiffness after the first update of the shaping iteration, which is also the limit of the iteration. The
/// weights of exact_shaping differ from the limit by about epsilon = 1e-6. Under merged_shaping each face is a group.
WedgeStiffness of_shaping(double w, double) {
  return of_weight(w, 1.0 / (1.0 + std::pow(std::cos(2.0 * w), 2)));
}

/// Returns the stiffness for S = u_r u_r^T; the mean gradient u_r points straight into the wedge.
WedgeStiffness of_averaged_direction(double, double) {
  return {1.0, 0.0};
}

/// Returns the stiffness for the projector onto the plane that the two gradients span.
WedgeStiffness of_plane(double, double) {
  return {1.0, 1.0};
}

/// Closed form of each algorithm's stiffness, with the algorithm's default parameters, in a wedge with n equally deep
/// points on each face.
const std::map<std::string, WedgeStiffness (*)(double w, double n)> kWedges = {
    {"original_averaging", of_averaged_direction},
    {"summation", of_weight},
    {"mean", [](double w, double) { return of_weight(w, 0.5); }},
    {"virtual_coupling", [](double w, double n) { return in_series(w, n, 1.0); }},
    {"shaped_stiffness", of_shaping},
    {"tandpasta", of_weight},  // every spring has the same beta, which sigma_E cancels
    {"normal_projection", of_shaping},
    {"exact_shaping", of_shaping},
    {"continuous_normal_projection", of_shaping},
    {"merged_shaping", of_shaping},
    {"proxy", of_plane},
    {"least_squares", [](double w, double n) { return in_series(w, n, 0.01); }},
    {"highest_depth", of_averaged_direction},
    {"mcneely", [](double w, double n) { return of_weight(w, std::min(n, 5.0)); }}};

TEST(Registry, EveryWedgeHasTheTensorOfItsClosedForm) {
  for (const auto& [name, wedge] : kWedges) {
    RenderingConfig config;
    config.algorithm = name;
    for (const double w : {0.1, 0.2, 0.5, 0.25 * std::numbers::pi, 1.0, 1.4}) {
      for (const std::size_t points : {1u, 3u, 7u}) {
        // Each of the two faces makes the angle w with the plane x = 0. +y points out of the wedge.
        test::Setting setting;
        setting.springs = SpringSet{std::vector<Vec3>(points, Vec3(std::cos(w), -std::sin(w), 0.0)), false};
        setting.springs->gradients.resize(2 * points, Vec3(-std::cos(w), -std::sin(w), 0.0));
        const Mat3 S = test::Probe(setting, config).force_at({{0.0, -1e-3, 0.0}, -Vec3::UnitY()}).S;
        const WedgeStiffness expected = wedge(w, static_cast<double>(points));
        // The weights solve linear equations with the smallest eigenvalue sin^2 2w. The error of the weights is the
        // error of the equations divided by this eigenvalue. The error of the equations is the regularisation (1e-6)
        // for exact_shaping and merged_shaping, and rounding for the other laws.
        const bool exact = config.algorithm == "exact_shaping" || config.algorithm == "merged_shaping";
        const double tolerance = (exact ? 2.0 * kExactShapingEpsilon : 1e-12) / std::pow(std::sin(2.0 * w), 2);
        EXPECT_LE((S - Mat3(Vec3(expected.across, expected.along, 0.0).asDiagonal())).norm(), tolerance)
            << name << " at " << w << " of " << points;
      }
    }
  }
}

TEST(ForceBound, HoldsForSpringsOfEqualDepthInClosedForm) {
  RenderingConfig config;
  const auto bound = [&](const char* algorithm, std::size_t n) {
    return find_algorithm(algorithm)->force_bound(config, Cylinder{}, n, 1.0);
  };
  for (const std::size_t n : {1u, 2u, 10u, 200u}) {
    const auto points = static_cast<double>(n);
    EXPECT_EQ(bound("summation", n), points);  // n parallel springs
    EXPECT_EQ(bound("mean", n), 1.0);
    EXPECT_GE(bound("virtual_coupling", n), points / (1.0 + points));  // n parallel springs in series with one spring
    EXPECT_GE(bound("least_squares", n), points / (0.01 + points));
    EXPECT_EQ(bound("highest_depth", n), 1.0);
    EXPECT_EQ(bound("mcneely", n), std::min(points, 10.0));
    EXPECT_EQ(bound("static_coupling", n), 30.0 / 20'000.0);  // newtons divided by newtons per metre
    EXPECT_GE(bound("shaped_stiffness", n), 1.0);
    EXPECT_LE(bound("shaped_stiffness", n), 3.0);
  }
  // The bound of a proxy is its largest motion in a step: 64 passes with a motion of at most a fifth of the radius of
  // 0.5 mm each.
  EXPECT_DOUBLE_EQ(bound("proxy", 1), 64 * 0.2 * 0.0005);
  config.iterations = 0;
  EXPECT_EQ(bound("shaped_stiffness", 50), 50.0);  // without iterations, the law equals summation
}

/// Returns a hash of the contacts of the tilted peg in its hole after the algorithm has processed them. Renders two
/// steps, so that a depth model with a memory affects the result.
std::uint64_t rendered_contacts(const RenderingConfig& config) {
  test::Setting setting;
  setting.tool = {0.0005, 0.005, Tip::round};
  setting.points = surface_points(Hole2d{});
  setting.pose = {{0.0, -0.004, 0.0}, {-std::sin(0.1), -std::cos(0.1), 0.0}};
  test::Probe probe(setting, config);
  probe.force_at({setting.pose.position + Vec3(0.00002, 0.00001, 0.0), setting.pose.axis});
  const RenderedForce force = probe.force_at(setting.pose);
  EXPECT_GT(probe.contacts().size(), 0u);
  return test::hash_of(force, probe.contacts());
}

TEST(Registry, BuiltAlgorithmsUseTheirFixedStages) {
  for (const AlgorithmEntry& entry : algorithms()) {
    RenderingConfig config;
    config.algorithm = entry.info->name;
    if (!entry.fixed_depth_model.empty()) {
      config.depth_model = entry.fixed_depth_model;
      const std::uint64_t fixed = rendered_contacts(config);
      for (const DepthModelEntry& other : depth_models()) {
        config.depth_model = other.info->name;
        EXPECT_EQ(rendered_contacts(config), fixed) << entry.info->name << " on " << other.info->name;
      }
    }
    const std::uint64_t without = rendered_contacts(config);
    config.reduction = ReductionConfig{};
    EXPECT_EQ(rendered_contacts(config) == without, !entry.may_reduce) << entry.info->name;
  }
}

TEST(Registry, TheDepthModelOfTheConfigurationIsUsedWhereItIsFree) {
  std::set<std::uint64_t> different;
  for (const DepthModelEntry& model : depth_models()) {
    RenderingConfig config;
    config.depth_model = model.info->name;
    different.insert(rendered_contacts(config));
  }
  EXPECT_EQ(different.size(), depth_models().size());
}

}  // namespace
}  // namespace hapbench::registry_test
