#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/support/scenes.hpp"

/// Every registered algorithm in every analytic scene, as test parameters: a new algorithm is covered by its line in
/// the registry, a new scene by its line in scenes.cpp.
namespace hapbench::test {

struct AlgorithmOnScene {
  std::string_view algorithm;
  const AnalyticScene* scene;

  std::string name() const { return std::string(algorithm) + "_on_" + std::string(scene->name); }
};

inline void PrintTo(const AlgorithmOnScene& instance, std::ostream* out) {
  *out << instance.name();
}

/// The instances to which a claim applies.
template <class Applies>
std::vector<AlgorithmOnScene> algorithms_on_scenes(Applies applies) {
  std::vector<AlgorithmOnScene> instances;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const AnalyticScene& scene : analytic_scenes()) {
      const AlgorithmOnScene instance{algorithm.info->name, &scene};
      if (applies(instance)) instances.push_back(instance);
    }
  }
  return instances;
}

inline bool always(const AlgorithmOnScene&) {
  return true;
}

/// The instance's setting and configuration, built once for each test.
class AlgorithmOnSceneTest : public testing::TestWithParam<AlgorithmOnScene> {
 protected:
  const AnalyticScene& scene() const { return *GetParam().scene; }

  Setting setting = GetParam().scene->setting();
  RenderingConfig config = config_for(GetParam().algorithm, *GetParam().scene);
  /// What rounding errors of a force are measured by [N]: the sum of all penalty forces, and a micrometre more because
  /// coordinates, not depths, are what is rounded.
  double magnitude = config.stiffness * (total_depth(setting, config) + 1e-6);
};

/// Rounding that any law may make of inputs that are exact in another order or another frame: coordinates and normals
/// move by a few 1e-16 of their size, 1e-12 of a depth of 0.1 mm, and the worst conditioned law, exact_shaping, knows
/// its single weights to 2e-16 over its epsilon of 1e-6.
inline constexpr double kAnyLawsRounding = 1e-9;

}  // namespace hapbench::test

/// Instantiates a suite derived from AlgorithmOnSceneTest; names read `summation_on_single_spring`.
#define HAPBENCH_FOR_EVERY_ALGORITHM(suite, applies)                                  \
  INSTANTIATE_TEST_SUITE_P(                                                           \
      Every, suite, testing::ValuesIn(hapbench::test::algorithms_on_scenes(applies)), \
      [](const testing::TestParamInfo<hapbench::test::AlgorithmOnScene>& instance) { return instance.param.name(); })
