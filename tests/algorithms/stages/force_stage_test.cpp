#include "algorithms/stages/force_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "sim/core/random.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/scenes.hpp"

namespace hapbench::force_stage_test {
namespace {

constexpr double kDt = 0.0005, kMass = 0.2;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A stage on rows whose motion is as foreseen: the tool goes v dt from row to row.
class Foreseen {
 public:
  explicit Foreseen(ForceStage& stage) : stage_(stage) {
    stage_.prepare(kDt, kMass);
    stage_.reset();
  }
  Vec3 answer(const Vec3& force, const Vec3& velocity) {
    ++rows_;
    const Vec3 given = stage_.force({force, velocity, energy});
    turnover += (force.norm() + given.norm()) * velocity.norm() * kDt;
    energy -= given.dot(velocity) * kDt;
    return given;
  }
  /// Of the roundings of so many rows.
  double rounding() const { return 20 * kEpsilon * static_cast<double>(rows_) * turnover; }

  double energy = 0.0, turnover = 0.0;

 private:
  ForceStage& stage_;
  std::uint64_t rows_ = 0;
};

Vec3 random_force(Random& random) {
  return std::pow(10.0, random.uniform(-2.0, 2.0)) * random.direction();
}
Vec3 random_velocity(Random& random) {
  return std::pow(10.0, random.uniform(-4.0, 0.0)) * random.direction();
}

TEST(EnergyTank, NeverGivesMoreThanItHoldsAndTakesOnlyPush) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const EnergyTankConfig config{std::pow(10.0, random.uniform(-5.0, 0.0)), 1e-4};
    EnergyTank tank(config);
    Foreseen rows(tank);
    double level = config.initial;  // what it holds, kept here
    level = std::min(level, config.capacity);
    for (int k = 0; k < 400; ++k) {
      const Vec3 f = random_force(random), v = random_velocity(random);
      const Vec3 given = rows.answer(f, v);
      const double wanted = f.dot(v) * kDt, gave = given.dot(v) * kDt;
      const double most = std::max(level, 0.0), rounding = rows.rounding();
      ASSERT_NEAR(gave, std::min(wanted, std::max(most, std::min(wanted, 0.0))), rounding) << seed << " " << k;
      // What is at right angles to the velocity stays, and so does a force that resists.
      ASSERT_LE((given - f).cross(v).norm(), 1e-12 * f.norm() * v.norm());
      if (wanted <= 0.0) {
        ASSERT_EQ(given, f);
      }
      level = std::min(config.capacity, level - gave);
      ASSERT_GE(level, -rounding);
    }
  }
}

TEST(ActuatorLimitedPassivity, WithoutLimitsOwesNothing) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    ActuatorLimitedPassivityConfig config;
    config.max_damping = 1e12;
    ActuatorLimitedPassivity stage(config);
    Foreseen rows(stage);
    for (int k = 0; k < 400; ++k) {
      const Vec3 f = random_force(random), v = random_velocity(random);
      const double before = rows.energy;
      const Vec3 given = rows.answer(f, v);
      ASSERT_GE(rows.energy, -rows.rounding()) << seed << " " << k;
      if (f.dot(v) * kDt <= before) {
        ASSERT_EQ(given, f);  // a passive force stays
      }
      // The direction of the force is enough here, so nothing is damped across it.
      ASSERT_LE(given.cross(f).norm(), 1e-9 * f.squaredNorm());
    }
  }
}

/// What the stage dissipates against the most that its limits allow, found by trying.
TEST(ActuatorLimitedPassivity, DissipatesWhatActuatorsAllowAndOwesTheRest) {
  bool owed_once = false, across_once = false;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    ActuatorLimitedPassivityConfig config;
    config.max_force = Vec3(random.uniform(1.0, 20.0), random.uniform(1.0, 20.0), random.uniform(1.0, 20.0));
    config.max_damping = std::pow(10.0, random.uniform(0.0, 3.0));
    ActuatorLimitedPassivity stage(config);
    Foreseen rows(stage);
    const auto allowed = [&](const Vec3& f) { return (f.cwiseAbs() - *config.max_force).maxCoeff() <= 1e-12; };
    for (int k = 0; k < 400; ++k) {
      const Vec3 f = random.uniform(0.0, 1.0) * config.max_force->minCoeff() * random.direction();
      const Vec3 v = random_velocity(random);
      const double owed = f.dot(v) * kDt - rows.energy;
      const Vec3 given = rows.answer(f, v);
      ASSERT_TRUE(allowed(given)) << given.transpose();
      const double taken = (f - given).dot(v) * kDt;
      ASSERT_GE(taken, -rows.rounding());
      ASSERT_LE(taken, std::max(owed, 0.0) + rows.rounding());
      if (owed <= 0.0) continue;
      // In the order of the priorities: a thousandth more of either damping would break a limit, or is not owed.
      const Vec3 n = f.normalized(), along = v.dot(n) * n, across = v - along;
      const double a1 = (f - given).dot(along) / along.squaredNorm();
      const double a2 = (f - given).dot(across) / across.squaredNorm();
      const Vec3 f1 = f - a1 * along;
      const double left = owed - a1 * along.squaredNorm() * kDt;
      const auto ends = [&](double a, const Vec3& g, const Vec3& part, double of) {
        const double more = 1.001 * a + 1e-6;
        return more > *config.max_damping || !allowed(g - more * part) || more * part.squaredNorm() * kDt >= of;
      };
      ASSERT_TRUE(ends(a1, f, along, owed)) << seed << " " << k;
      ASSERT_TRUE(ends(a2, f1, across, left)) << seed << " " << k;
      across_once |= a2 > 1e-3;
      owed_once |= taken < 0.9 * owed;
    }
  }
  EXPECT_TRUE(owed_once);
  EXPECT_TRUE(across_once);
}

/// A stage made of a function.
class FakeStage final : public ForceStage {
 public:
  using Answer = std::function<Vec3(const StageStep&)>;
  explicit FakeStage(Answer answer) : answer_(std::move(answer)) {}
  void prepare(double, double) override {}
  void reset() noexcept override {}
  Vec3 force(const StageStep& step) noexcept override { return answer_(step); }

 private:
  Answer answer_;
};

SimulationParts staged(SimulationParts parts, FakeStage::Answer answer, const RenderingConfig& config = {}) {
  parts.algorithm = std::make_unique<StagedRendering>(std::move(parts.algorithm),
                                                      std::make_unique<FakeStage>(std::move(answer)), config);
  return parts;
}

Vec3 damped_spring(const ToolState& tool) {
  return -3000.0 * tool.pose.position - 5.0 * tool.velocity;
}

TEST(StagedRendering, AnIdleStageMovesNoBitUnderAnyIntegrator) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    SCOPED_TRACE(integrator->info.name);
    SimulationConfig config = test::thrown(300);
    config.integrator = integrator;
    test::Recorder bare, with;
    Simulation(config, test::fake_parts(damped_spring), {&bare}).run();
    const auto same = [](const StageStep& s) -> Vec3 { return s.force; };
    Simulation staged_run(config, staged(test::fake_parts(damped_spring), same), {&with});
    staged_run.run();
    ASSERT_EQ(bare.rows.size(), with.rows.size());
    for (std::size_t k = 0; k < bare.rows.size(); ++k)
      ASSERT_EQ(bare.rows[k].tool.pose.position, with.rows[k].tool.pose.position);
    EXPECT_EQ(staged_run.algorithm().work().steps_staged, 0u);
    EXPECT_EQ(staged_run.algorithm().work().energy_staged, 0.0);
  }
}

/// Along the way of the run, by the mean velocity of two rows, which is exact under leapfrog.
TEST(StagedRendering, CountsWhatTheStageTakesAndWhatItAbsorbs) {
  std::vector<double> energies;
  const auto weaker = [&energies](const StageStep& s) -> Vec3 {
    energies.push_back(s.energy);
    return energies.size() % 3 == 1 ? s.force : Vec3(0.5 * s.force);
  };
  test::Recorder recorder;
  Simulation run(test::thrown(300), staged(test::fake_parts(damped_spring), weaker), {&recorder});
  run.run();
  const auto& rows = recorder.rows;
  double taken = 0.0, absorbed = 0.0;
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    ASSERT_NEAR(energies[k], absorbed, 1e-15) << k;  // of energies of 1e-3 J
    const Vec3 way = 0.5 * kDt * (rows[k].tool.velocity + rows[k + 1].tool.velocity);
    taken += (damped_spring(rows[k].tool) - rows[k].force.rendered).dot(way);
    absorbed -= rows[k].force.rendered.dot(way);
  }
  EXPECT_NEAR(run.algorithm().work().energy_staged, taken, 1e-15);
  EXPECT_NE(taken, 0.0);
  EXPECT_EQ(run.algorithm().work().steps_staged, 200u);
}

TEST(StagedRendering, TellsTheRowAndCutsTheAnswerToTheForceLimit) {
  RenderingConfig config;
  config.max_force = 2.0;
  config.mass = 0.3;
  StageStep last{};
  const auto strong = [&last](const StageStep& s) -> Vec3 {
    last = s;
    return {30.0, 0.0, 40.0};
  };
  test::Recorder recorder;
  SimulationParts parts = staged(test::fake_parts(damped_spring), strong, config);
  Simulation run(test::thrown(50), std::move(parts), {&recorder});
  run.run();
  const StepRecord& row = recorder.rows.back();
  EXPECT_TRUE(row.force.rendered.isApprox(Vec3(1.2, 0.0, 1.6), 1e-15));
  EXPECT_EQ(row.force.spring, damped_spring(row.tool));
  EXPECT_EQ(last.force, damped_spring(row.tool));
  EXPECT_EQ(last.velocity, row.tool.velocity);
}

}  // namespace
}  // namespace hapbench::force_stage_test
