#include "sim/loop/integrators/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "sim/core/random.hpp"
#include "sim/loop/integrators/spring_damper.hpp"

/// Whatever a row of the table says is true of its integrator.
namespace hapbench::table_test {
namespace {

TEST(IntegratorTable, HasUniqueNamesThatAreFound) {
  std::set<std::string> names;
  for (const IntegratorEntry* entry : kIntegrators) {
    EXPECT_TRUE(names.insert(entry->info.name).second) << entry->info.name;
    EXPECT_EQ(find_integrator(entry->info.name), entry);
    EXPECT_NE(entry->make(), nullptr) << entry->info.name;
  }
  EXPECT_EQ(find_integrator("no_such"), nullptr);
  EXPECT_EQ(find_integrator(""), nullptr);
}

TEST(IntegratorTable, DocumentsEveryRow) {
  for (const IntegratorEntry* entry : kIntegrators) {
    const ModelInfo& info = entry->info;
    for (const char* text : {info.name, info.summary, info.formula, info.source, info.known_failure}) {
      ASSERT_NE(text, nullptr);
      EXPECT_FALSE(std::string(text).empty()) << info.name;
    }
  }
}

/// Of random spring-dampers, on either side of the stability limits.
template <class Check>
void for_random_systems(const IntegratorEntry* integrator, Check check) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    SpringDamper system{random.uniform(0.0, 4e6), random.uniform(0.0, 1e3), 0.1, 0.0005, random.uniform(0.5, 2.0)};
    if (i % 5 == 0) system.B = 0.0;
    if (i % 5 == 1) system.K = 0.0;
    system.integrator = integrator;
    check(system);
  }
}

TEST(IntegratorTable, StepMatricesInClosedFormAreThoseOfTheIntegrators) {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->step_matrix == nullptr) continue;
    IntegratorEntry plain = *entry;
    plain.step_matrix = nullptr;  // the matrix is then built from the integrator
    for_random_systems(entry, [&](SpringDamper system) {
      const Eigen::Matrix2d closed = system.step_matrix();
      system.integrator = &plain;
      EXPECT_LE((closed - system.step_matrix()).norm(), 1e-14 * closed.norm()) << entry->info.name;
    });
  }
}

TEST(IntegratorTable, MarginsArePositiveExactlyWhereAStepIsStable) {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->stability_margin == nullptr) continue;
    for_random_systems(entry, [&](const SpringDamper& system) {
      if (std::abs(*system.margin()) < 1e-9) return;  // on the limit itself, to rounding
      EXPECT_EQ(*system.margin() > 0.0, system.is_stable()) << entry->info.name << " " << system.K << " " << system.B;
    });
  }
}

/// A step a little below a limit is stable, a little above it is not; without a limit every step is stable.
TEST(IntegratorTable, LimitsAreWhereStepsBecomeUnstable) {
  constexpr double kMargin = 1e-6;
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->stability_limit == nullptr) continue;
    for (const StabilityCase raised : kStabilityCases) {
      for (const double lambda : {1.0, 3.0}) {
        for (const double zeta : {0.0, 0.7}) {
          const SpringDamper given{20000.0, 0.0, 0.1, 0.0005, lambda, entry};
          const RaisedSpringDamper problem{raised, given, {}, zeta};
          const std::optional<double> limit = entry->stability_limit(problem);
          if (!limit) continue;
          SCOPED_TRACE(std::string(entry->info.name) + " case " + std::to_string(static_cast<int>(raised)));
          if (std::isfinite(*limit)) {
            EXPECT_TRUE(problem.at(*limit * (1.0 - kMargin)).is_stable());
            EXPECT_FALSE(problem.at(*limit * (1.0 + kMargin)).is_stable());
          } else {
            EXPECT_TRUE(problem.at(raised == StabilityCase::time_step ? 1.0 : 1e9).is_stable());
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace hapbench::table_test
