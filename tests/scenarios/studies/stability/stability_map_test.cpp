#include "scenarios/studies/stability/stability_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"

namespace hapbench::stability_map_test {
namespace {

const JobOptions kTwoThreads{2, ""};

struct MapOfAlgorithm {
  const StabilityMap* map;
  std::string algorithm;
};

void PrintTo(const MapOfAlgorithm& instance, std::ostream* out) {
  *out << instance.map->name << " " << instance.algorithm;
}

bool is_of_springs(const StabilityMap& map) {
  return std::holds_alternative<IdealDeviceFields>(map.scene(map.x.low, map.y.low, "mean").device);
}

std::vector<MapOfAlgorithm> spring_maps() {
  std::vector<MapOfAlgorithm> all;
  for (const StabilityMap& map : stability_maps()) {
    if (!is_of_springs(map)) continue;
    for (const AlgorithmEntry& entry : algorithms()) {
      // A coupling that saturates is not linear in the position, nor is the greater of two depths.
      if (std::string_view(entry.info->name) == "static_coupling") continue;
      if (std::string_view(map.name) == "wedge" && std::string_view(entry.info->name) == "highest_depth") continue;
      all.push_back({&map, entry.info->name});
    }
  }
  return all;
}

class SpringMap : public testing::TestWithParam<MapOfAlgorithm> {};
INSTANTIATE_TEST_SUITE_P(Every, SpringMap, testing::ValuesIn(spring_maps()), [](const auto& instance) {
  return std::string(instance.param.map->name) + "_" + instance.param.algorithm;
});

TEST_P(SpringMap, HasItsEdgeWithinTwoPercentOfTheAnalyticLimitAndDivergesOnlyBeyond) {
  const MapResult result = stability_map(*GetParam().map, {GetParam().algorithm}, 3, kTwoThreads);
  ASSERT_EQ(result.boundary.size(), 3u);
  for (const BoundaryPoint& point : result.boundary) {
    // Bilateral springs in constant contact: these laws are linear there, so the theory applies everywhere.
    ASSERT_TRUE(point.analytic) << point.no_theory;
    EXPECT_LE(std::abs(*point.difference()), 0.02)
        << "x = " << point.x << ": " << point.simulation << " instead of " << *point.analytic;
  }
  ASSERT_EQ(result.points.size(), 9u);
  for (const MapPoint& point : result.points) {
    ASSERT_TRUE(point.margin);
    // At 1 % from the limit and more, the growth of kMapSteps steps cannot be overlooked.
    if (std::abs(*point.margin) < 0.04) continue;
    EXPECT_EQ(point.verdict == RunVerdict::diverged, *point.margin < 0.0) << point.x << " " << point.y;
  }
}

TEST(StabilityMap, HasNoTheoryForALawThatIsNotLinear) {
  const MapResult result = stability_map(*find_stability_map("wedge"), {"highest_depth"}, 3, kTwoThreads);
  ASSERT_EQ(result.boundary.size(), 3u);
  EXPECT_FALSE(result.boundary[1].analytic) << "a right angle";
  EXPECT_EQ(result.boundary[1].no_theory, "the force is not -K S p");
}

/// lambda_max(S) in closed form, where the law's weights are.
TEST(StabilityMap, ReportsTheTensorOfTheRun) {
  const auto lambdas = [](const char* map, const char* algorithm, auto expected) {
    const MapResult result = stability_map(*find_stability_map(map), {algorithm}, 4, kTwoThreads);
    for (const MapPoint& point : result.points) {
      EXPECT_NEAR(point.lambda, expected(point.x), 1e-12 * (1.0 + expected(point.x))) << algorithm << " " << point.x;
    }
  };
  lambdas("contacts", "summation", [](double n) { return n; });
  lambdas("contacts", "mean", [](double) { return 1.0; });
  lambdas("contacts", "shaped_stiffness", [](double) { return 1.0; });
  lambdas("contacts", "virtual_coupling", [](double n) { return n / (1.0 + n); });  // in series, K_vc = K
  // Two unit vectors at pi - angle: the eigenvalues of u u^T + v v^T are 1 ± cos(angle).
  lambdas("wedge", "summation", [](double angle) { return 1.0 + std::abs(std::cos(angle)); });
  lambdas("wedge", "mean", [](double angle) { return 0.5 + 0.5 * std::abs(std::cos(angle)); });
}

TEST(StabilityMap, WithoutDampingVibratesUpToTheLimit) {
  const MapResult result = stability_map(*find_stability_map("damping_ratio"), {"summation"}, 6, kTwoThreads);
  for (const MapPoint& point : result.points) {
    if (point.x == 0.0) {
      EXPECT_EQ(point.verdict, point.y < 1.6e6 ? RunVerdict::vibrating : RunVerdict::diverged) << point.y;
    }
  }
  EXPECT_NEAR(*result.boundary[0].analytic, 1.6e6, 1e-3);  // 4 M / dt^2
}

TEST(StabilityMap, OfTheAdmittanceDeviceHasTheEdgeOfItsLoop) {
  const StabilityMap& map = *find_stability_map("device");
  const MapResult result = stability_map(map, {"summation"}, 3, kTwoThreads);
  for (const MapPoint& point : result.points) EXPECT_FALSE(point.margin);
  // Below the edge nothing saturates for long: what is linear then comes to rest. Beyond, the limiter of the input
  // keeps runs from growing that the loop would let grow.
  const double edge = *result.boundary[0].analytic;
  EXPECT_GT(edge, 1000.0);
  EXPECT_GT(result.boundary[0].simulation, edge);
  EXPECT_EQ(result.points.front().verdict, RunVerdict::stable);
  // A servo eight samples late comes to rest under no hand.
  EXPECT_EQ(*result.boundary[1].analytic, 0.0);
  EXPECT_EQ(result.boundary[1].simulation, 0.0);
}

/// Runs and eigenvalues have the same edge as long as nothing saturates.
TEST(StabilityMap, OfTheImpedanceDeviceHasItsEdgeWithinOnePercentOfTheLoops) {
  for (const char* name : {"z_width", "delay", "velocity_filter", "hand"}) {
    const MapResult result = stability_map(*find_stability_map(name), {"shaped_stiffness"}, 3, kTwoThreads);
    for (const BoundaryPoint& point : result.boundary) {
      ASSERT_TRUE(point.analytic) << point.no_theory;
      EXPECT_LE(std::abs(*point.difference()), 0.01) << name << ", x = " << point.x;
      EXPECT_LE(*point.worst_hand, *point.analytic * (1.0 + 1e-9));
    }
  }
}

std::optional<double> limit_at(const BoundaryPoint& point, const char* name) {
  const auto row = find_stiffness_limit(name) - stiffness_limits().data();
  return point.limits[static_cast<std::size_t>(row)];
}

TEST(StabilityMap, HasTheKnownLimitsOfTheStiffnessBesideItsEdge) {
  const MapResult result = stability_map(*find_stability_map("z_width"), {"virtual_coupling"}, 3, kTwoThreads);
  // Springs of K in series with a coupling of K are a wall of half the stiffness and damping.
  const BoundaryPoint& point = result.boundary[0];
  EXPECT_NEAR(*limit_at(point, "passive_colgate_schenkel"), 2.0 * 2.0 * (0.5 - 0.5 * 0.1) / 0.001, 1e-6);
  EXPECT_NEAR(*limit_at(point, "stable_gil_hulin"), 2.0 * (0.5 + 0.5 * 0.1) / 0.0005, 1e-6);
  EXPECT_FALSE(limit_at(point, "passive_abbott_okamura"));
  for (const BoundaryPoint& p : stability_map(*find_stability_map("wedge"), {"mean"}, 2, kTwoThreads).boundary) {
    EXPECT_FALSE(p.worst_hand);
    for (const auto& limit : p.limits) EXPECT_FALSE(limit) << "of impedance devices";
  }
}

/// The four regions: either friction or damping alone leaves large motions or small ones undone.
TEST(StabilityMap, OfFrictionHasFourRegions) {
  const MapResult result = stability_map(*find_stability_map("friction_quantisation"), {"summation"}, 4, kTwoThreads);
  for (const MapPoint& point : result.points) {
    SCOPED_TRACE(testing::Message() << point.x << " " << point.y);
    ASSERT_TRUE(point.verdict_from_far);
    EXPECT_EQ(is_stable(point.verdict), point.y > 1.0) << "friction covers the steps of the encoder";
    EXPECT_EQ(*point.verdict_from_far == RunVerdict::diverged, point.x < 1.0) << "damping covers the sampling";
  }
  for (const BoundaryPoint& point : result.boundary) {
    EXPECT_FALSE(point.analytic);
    EXPECT_NEAR(point.simulation, 1.0, 0.002) << point.x;  // bisection stops at 0.1 %
    const auto limit = limit_at(point, "passive_abbott_okamura");
    EXPECT_EQ(limit.has_value(), point.x > 1.0);
    EXPECT_NEAR(limit.value_or(1.0), 1.0, 1e-8);
  }
}

/// K up to min(2b/T, 2c/q) is passive; runs find the second number itself, and a little more than the first, since what
/// is passive must bear faster motions than theirs.
TEST(StabilityMap, OfTheEncoderFollowsAbbottAndOkamura) {
  const MapResult result = stability_map(*find_stability_map("encoder_step"), {"summation"}, 3, kTwoThreads);
  for (const BoundaryPoint& point : result.boundary) {
    const double limit = limit_at(point, "passive_abbott_okamura").value();
    EXPECT_NEAR(limit, std::min(1000.0, 2.0 * 0.02 / point.x), 1e-9 * limit);
    EXPECT_NEAR(point.simulation, limit, (limit < 1000.0 ? 0.002 : 0.1) * limit) << point.x;
  }
}

class IntegratorMap : public testing::TestWithParam<const IntegratorEntry*> {};
INSTANTIATE_TEST_SUITE_P(Every, IntegratorMap, testing::ValuesIn(kIntegrators),
                         [](const auto& instance) { return instance.param->info.name; });

/// Bilateral springs are linear under every integrator, so its runs must end where an eigenvalue of its step leaves the
/// unit circle, and never where none does.
TEST_P(IntegratorMap, HasItsEdgeWithinTwoPercentOfTheory) {
  for (const auto& [map, algorithm] : {std::pair{"time_step", "shaped_stiffness"},
                                       {"damping_ratio", "shaped_stiffness"},
                                       {"wedge", "mean"},
                                       {"wedge", "virtual_coupling"},
                                       {"contacts", "summation"}}) {
    SCOPED_TRACE(std::string(map) + " " + algorithm);
    const MapResult result = stability_map(*find_stability_map(map), {algorithm, GetParam()}, 3, kTwoThreads);
    for (const BoundaryPoint& point : result.boundary) {
      ASSERT_TRUE(point.analytic) << map;
      EXPECT_LE(std::abs(*point.difference()), 0.02)
          << map << ", x = " << point.x << ": " << point.simulation << " instead of " << *point.analytic;
    }
    for (const MapPoint& point : result.points) {
      EXPECT_EQ(point.margin.has_value(), GetParam()->stability_margin != nullptr);
    }
  }
}

TEST(StabilityMap, KnowsTheLimitsOfOtherIntegratorsInClosedForm) {
  const StabilityMap& map = *find_stability_map("damping_ratio");
  const auto undamped = [&](const IntegratorEntry* integrator) {
    return *stability_map(map, {"mean", integrator}, 2, kTwoThreads).boundary[0].analytic;
  };
  EXPECT_NEAR(undamped(&kVelocityVerlet), 1.6e6, 1e-3);  // 4 M / dt^2
  EXPECT_NEAR(undamped(&kRk4), 3.2e6, 1e-3);             // 8 M / dt^2
  EXPECT_EQ(undamped(&kImplicitEuler), std::numeric_limits<double>::infinity());
  EXPECT_EQ(undamped(&kImplicitMidpoint), std::numeric_limits<double>::infinity());
}

/// A handle with hardly any damping, at a wall that is stable to 1200 N/m, is held bounded far beyond by either stage.
/// Within the explicit step of a virtual mass neither sees anything: its edge stays.
TEST(StabilityMap, TakesAForceStageAndThenKnowsNoLimit) {
  const StabilityMap &handle = *find_stability_map("z_width"), &tool = *find_stability_map("contacts");
  const double bare = stability_map(handle, {"summation"}, 2, kTwoThreads).boundary[0].simulation;
  const double limit = stability_map(tool, {"summation"}, 2, kTwoThreads).boundary[0].simulation;
  for (const char* stage :
       {R"({"type":"energy_tank"})", R"({"type":"actuator_limited_passivity","max_damping_N_s_per_m":100})"}) {
    SCOPED_TRACE(stage);
    const std::vector<std::string> with = {std::string("rendering.force_stage=") + stage};
    for (const StabilityMap* map : {&handle, &tool}) {
      require_overridable(*map, with);
      const MapResult result = stability_map(*map, {"summation", &kLeapfrog, with}, 2, kTwoThreads);
      for (const BoundaryPoint& point : result.boundary) {
        EXPECT_FALSE(point.analytic);
        EXPECT_EQ(point.no_theory, "a force stage changes the force");
      }
      for (const MapPoint& point : result.points) EXPECT_FALSE(point.margin);
      if (map == &handle) {
        EXPECT_GT(result.boundary[0].simulation, 20.0 * bare);
      } else {
        EXPECT_EQ(result.boundary[0].simulation, limit);
      }
    }
  }
}

std::vector<std::string> dry_friction(const std::string& more) {
  return {R"(rendering.friction={"type":"dry","mu":0.5)" + more + "}"};
}

/// K_t = K, and so the closed form of A.3 at the friction's own zeta, at every zeta of the springs; the tensor of
/// parallel springs is not the bristle's.
TEST(StabilityMap, WithDryFrictionHasTheEdgeAlongTheWallInClosedForm) {
  const auto a3 = [](double zeta) { return 0.1 * std::pow(2.0 * (std::sqrt(1.0 + zeta * zeta) - zeta) / 0.0005, 2); };
  for (const char* name : {"damping_ratio", "contacts"}) {
    const StabilityMap& map = *find_stability_map(name);
    const MapSubject bare{"summation"}, dry{"summation", &kLeapfrog, dry_friction("")};
    const MapResult springs = stability_map(map, bare, 3, kTwoThreads), held = stability_map(map, dry, 3, kTwoThreads);
    for (std::size_t i = 0; i < 3; ++i) {
      SCOPED_TRACE(testing::Message() << name << " " << held.boundary[i].x);
      const BoundaryPoint& point = held.boundary[i];
      EXPECT_FALSE(springs.boundary[i].tangent);
      EXPECT_EQ(point.analytic, springs.boundary[i].analytic);
      EXPECT_NEAR(*point.tangent, a3(1.0), 1e-6 * a3(1.0));
      EXPECT_NEAR(*point.theory(), std::min(*point.analytic, a3(1.0)), 1e-6 * *point.theory());
      EXPECT_LE(std::abs(*point.difference()), 0.02);
    }
    for (const MapPoint& point : held.points) EXPECT_EQ(point.verdict == RunVerdict::diverged, *point.margin < 0.0);
  }
  // That of `stability`, under an integrator without a closed form of both.
  Scenario scenario = find_stability_map("time_step")->scene(0.0005, 1e4, "mean");
  scenario.integrator.type = &kRk4;
  scenario.rendering.dry_friction = {.mu = 0.5, .stiffness = {}};
  const MapSubject rk4{"mean", &kRk4, dry_friction("")};
  const BoundaryPoint at_default = stability_map(*find_stability_map("mass"), rk4, 3, kTwoThreads).boundary[1];
  scenario.rendering.mass = at_default.x;
  EXPECT_NEAR(*at_default.theory(), stability_limits(scenario).back().eigenvalue, 1e-8 * *at_default.theory());
}

/// On a device, too, across and along the wall: whichever is the lesser is the edge of the runs.
TEST(StabilityMap, WithDryFrictionOnTheImpedanceDeviceHasTheLesserEdgeWithinOnePercentOfTheLoops) {
  int across = 0, along = 0;
  for (const char* name : {"z_width", "delay", "velocity_filter", "hand"}) {
    for (const char* more : {R"(,"damping_ratio":0.1)", ""}) {
      const MapSubject subject{"shaped_stiffness", &kLeapfrog, dry_friction(more)};
      require_overridable(*find_stability_map(name), subject.overrides);
      for (const BoundaryPoint& point : stability_map(*find_stability_map(name), subject, 4, kTwoThreads).boundary) {
        ASSERT_TRUE(point.tangent) << point.no_theory;
        EXPECT_LE(std::abs(*point.difference()), 0.01) << name << more << ", x = " << point.x;
        ++(*point.tangent < *point.analytic ? along : across);
      }
    }
  }
  EXPECT_GT(across, 3);
  EXPECT_GT(along, 3);
}

TEST(StabilityMap, TakesDryFrictionOnlyWhereItHoldsALinearTool) {
  for (const char* name : {"wedge", "device", "encoder_step"})
    EXPECT_THROW(require_overridable(*find_stability_map(name), dry_friction("")), InputError) << name;
  const StabilityMap& map = *find_stability_map("z_width");
  require_overridable(map, dry_friction(""));
  EXPECT_THROW(require_overridable(map, {"rendering.friction.mu_s_N_s_per_m=1"}), InputError);
  for (const char* with : {"device.coulomb_N=0.1", "device.force_max_N=5", R"(hand={"type":"push","force_N":1})"}) {
    std::vector<std::string> overrides = dry_friction("");
    overrides.emplace_back(with);
    EXPECT_THROW(require_overridable(map, overrides), InputError) << with;
  }
}

TEST(MapAxis, CoversItsRange) {
  for (const StabilityMap& map : stability_maps()) {
    for (const MapAxis& axis : {map.x, map.y}) {
      EXPECT_NEAR(axis.at(0, 7), axis.low, 1e-12 * axis.low) << axis.name;
      EXPECT_NEAR(axis.at(6, 7), axis.high, 1e-12 * axis.high) << axis.name;
      for (std::size_t i = 1; i < 7; ++i) EXPECT_GT(axis.at(i, 7), axis.at(i - 1, 7)) << axis.name;
      for (std::size_t i = 0; axis.whole && i < 7; ++i) EXPECT_EQ(axis.at(i, 7), std::round(axis.at(i, 7)));
    }
  }
}

}  // namespace
}  // namespace hapbench::stability_map_test
