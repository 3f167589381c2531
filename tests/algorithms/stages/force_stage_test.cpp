#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "algorithms/stages/controllers.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/core/random.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::force_stage_test {
namespace {

constexpr double kDt = 0.0005, kMass = 0.2;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Calls a force stage in successive steps. From step to step the tool moves by v dt, as the stage predicts.
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
  /// Returns a bound of the rounding error that the steps so far have accumulated [J].
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
    double level = config.initial;  // level of the tank, computed by the test
    level = std::min(level, config.capacity);
    for (int k = 0; k < 400; ++k) {
      const Vec3 f = random_force(random), v = random_velocity(random);
      const Vec3 given = rows.answer(f, v);
      const double wanted = f.dot(v) * kDt, gave = given.dot(v) * kDt;
      const double allowed = std::max(level, 0.0), rounding = rows.rounding();
      ASSERT_NEAR(gave, std::min(wanted, std::max(allowed, std::min(wanted, 0.0))), rounding) << seed << " " << k;
      // The force component perpendicular to the velocity is unchanged, and so is a force that resists the motion.
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
        ASSERT_EQ(given, f);  // a passive force is unchanged
      }
      // Damping along the force is sufficient here, so there is no damping perpendicular to the force.
      ASSERT_LE(given.cross(f).norm(), 1e-9 * f.squaredNorm());
    }
  }
}

/// Checks that the stage damps as much as its limits and its energy debt allow: slightly more damping would break a
/// limit or dissipate more than the debt.
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
      // The stage adds damping first along the force (a1), and then perpendicular to the force (a2). Check that each
      // damping is as large as possible: if it were larger by a thousandth, it would break a limit, or would dissipate
      // more than the debt.
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

/// A force stage whose force is a given function of the step.
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

/// Checks the energies that the stage counts against the work of the forces along the path of the run. The displacement
/// of a step is computed with the mean velocity of two steps, which is exact under leapfrog.
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
    ASSERT_NEAR(energies[k], absorbed, 1e-15) << k;  // energies are about 1e-3 J
    const Vec3 displacement = 0.5 * kDt * (rows[k].tool.velocity + rows[k + 1].tool.velocity);
    taken += (damped_spring(rows[k].tool) - rows[k].force.rendered).dot(displacement);
    absorbed -= rows[k].force.rendered.dot(displacement);
  }
  EXPECT_NEAR(run.algorithm().work().energy_staged, taken, 1e-15);
  EXPECT_NE(taken, 0.0);
  EXPECT_EQ(run.algorithm().work().steps_staged, 200u);
}

TEST(StagedRendering, GetsTheRowAndItsForceIsClampedToTheLimit) {
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

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Returns dyadic values, so that products below are exact: B = 2 zeta sqrt(K M) = 2 * 0.75 * 64 = 96.
RenderingConfig dyadic() {
  RenderingConfig config;
  config.stiffness = 8192.0;
  config.mass = 0.5;
  config.damping_ratio = 0.75;
  return config;
}

const Mat3 kS = Vec3(1.0, 0.5, 0.0).asDiagonal();
const Vec3 kSpring(-4.0, 8.0, 0.0);
const Vec3 kVelocity(0.5, 0.25, -2.0);

/// Returns the rendered force for a tool that does not rotate.
Vec3 rendered(const RenderingConfig& config, const Vec3& spring = kSpring, const Mat3& S = kS,
              const Vec3& v = kVelocity) {
  return DampingAndLimits(config).rendered_force(spring, S, {v, S * v});
}

TEST(Damping, ActsOnTheNormalVelocityOfTheContactsWhereItIsGiven) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  // The tangential velocity is v_t = (1, 2, 3) - (0.5, 0, 1).
  const ContactVelocity velocity{{1.0, 2.0, 3.0}, {0.5, 0.0, 1.0}};
  const Vec3 force = DampingAndLimits(config).rendered_force(kSpring, kS, velocity);
  EXPECT_EQ(force, Vec3(kSpring - 96 * velocity.normal - 3.0 * Vec3(0.5, 2.0, 2.0)));
  config.max_damping = 24.0;
  EXPECT_EQ(DampingAndLimits(config).rendered_force(kSpring, kS, velocity),
            Vec3(kSpring - 24 * velocity.normal - 3.0 * Vec3(0.5, 2.0, 2.0)));
}

TEST(MaxDamping, CutsTheNormalDampingInTheStiffestDirectionOfS) {
  RenderingConfig config = dyadic();
  config.max_damping = 24.0;
  const Mat3 S = Vec3(1.0, 4.0, 2.0).asDiagonal();  // lambda_max(B S) = 4 * 96
  EXPECT_EQ(rendered(config, Vec3::Zero(), S, {1, 1, 1}), Vec3(-6.0, -24.0, -12.0));
}

TEST(MaxForce, ScalesTheRenderedForceToItsLength) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  const Vec3 without = rendered(config);
  config.max_force = 10.0;
  EXPECT_NEAR(rendered(config).norm(), 10.0, 4 * kEps * 10);
  EXPECT_LE((rendered(config).normalized() - without.normalized()).norm(), 4 * kEps);
}

RenderingConfig rendering(double mu, std::optional<double> stiffness = {}, double damping_ratio = 1.0) {
  RenderingConfig config;
  config.mass = 0.1;
  config.dry_friction = DryFrictionConfig{mu, stiffness, damping_ratio};
  return config;
}

DryFriction friction_of(const RenderingConfig& config) {
  return {*config.dry_friction, config};
}

Mat3 load(const Vec3& u, double newtons) {
  return newtons * u * u.transpose();
}

/// Checks that in every step, the work that the tool does against friction is at least the increase of the bristle's
/// energy, for any motion, loads and normals. The tolerance is the rounding error of about 50 operations on energies of
/// the size of K_t e^2, where K_t is the stiffness and e the deflection of the bristle.
TEST(DryFriction, IsPassiveForAnyMotionLoadsAndNormals) {
  Random random(1);
  for (int run = 0; run < 400; ++run) {
    const double K_t = std::pow(10.0, random.uniform(2.0, 5.5));
    DryFriction friction = friction_of(rendering(random.uniform(0.0, 1.5), K_t, random.uniform(0.0, 2.0)));
    Vec3 u = random.direction();
    for (int step = 0; step < 200; ++step) {
      Mat3 loads = Mat3::Zero();
      if (random.below(10) == 0) u = random.direction();
      for (std::uint64_t n = random.below(4); n > 0; --n) {
        loads += load((u + 0.8 * random.direction()).normalized(), random.uniform(0.0, 5.0));
      }
      const Vec3 displacement = random.uniform(0.0, 2e-4) * random.direction();
      const double before = friction.energy();
      const Vec3 force = friction.force(loads, displacement / kDt);
      const double scale = before + friction.energy() + force.norm() * displacement.norm();
      ASSERT_GE(-force.dot(displacement), friction.energy() - before - 50 * 2.3e-16 * scale) << run << " " << step;
    }
  }
}

TEST(DryFriction, SlidingIsCoulombsForceOnAFaceASlotAndTheLineOfAWedge) {
  const Vec3 along = Vec3::UnitX();
  const Vec3 left = Vec3(0.0, 0.8, 0.6), right = Vec3(0.0, -0.8, 0.6);
  for (const Mat3& loads : {load(Vec3::UnitZ(), 3.0), Mat3(load(Vec3::UnitZ(), 1.0) + load(-Vec3::UnitZ(), 2.0)),
                            Mat3(load(left, 1.0) + load(right, 2.0))}) {
    DryFriction friction = friction_of(rendering(0.3));
    Vec3 force;
    for (int step = 0; step < 400; ++step) force = friction.force(loads, 0.1 * along);
    EXPECT_LE((force + 0.9 * along).norm(), 1e-14);
    EXPECT_EQ(friction.state(), Friction::slides);
  }
}

TEST(DryFriction, ForgetsItsBristleWithoutLoad) {
  DryFriction friction = friction_of(rendering(0.5));
  friction.force(load(Vec3::UnitZ(), 1.0), {0.01, 0.0, 0.0});
  EXPECT_GT(friction.energy(), 0.0);
  EXPECT_EQ(friction.force(Mat3::Zero(), {0.01, 0.0, 0.0}), Vec3(Vec3::Zero()));
  EXPECT_EQ(friction.energy(), 0.0);
  EXPECT_EQ(friction.state(), Friction::none);
}

/// Checks that integrators which evaluate several states in a step move the bristle only once.
TEST(DryFriction, TheBristleMovesOnceARow) {
  std::uint64_t row = 0;
  Scene scene;
  scene.row = &row;
  DryFriction once = friction_of(rendering(0.5)), often = friction_of(rendering(0.5));
  once.prepare(scene);
  often.prepare(scene);
  for (; row < 100; ++row) {
    const Vec3 v(0.01 * std::sin(0.1 * static_cast<double>(row)), 0.0, 0.0);
    EXPECT_EQ(once.force(load(Vec3::UnitZ(), 1.0), v), often.force(load(Vec3::UnitZ(), 1.0), v));
    often.force(load(Vec3::UnitZ(), 1.0), -v);
    EXPECT_EQ(once.energy(), often.energy());
  }
}

/// Checks a bounce off one spring with the damping force f_dn = -chi K d <v, u> u at the depth d. The speeds u0 before
/// and u1 after the bounce satisfy chi u0 - ln(1 + chi u0) = -chi u1 - ln(1 - chi u1).
TEST(HuntCrossley, BouncesAsItsClosedFormSays) {
  for (const double chi : {0.5, 5.0, 50.0}) {
    RenderingConfig config;
    config.stiffness = 1000.0;
    config.mass = 0.1;
    config.hunt_crossley = chi;
    DampingAndLimits stage(config);
    const double u0 = 0.2;
    const auto acceleration = [&](double d, double v) {
      if (d <= 0.0) return 0.0;
      const Vec3 spring(0.0, 0.0, -config.stiffness * d), velocity(0.0, 0.0, v);
      const Mat3 S = load(Vec3::UnitZ(), 1.0);
      return stage.rendered_force(spring, S, {velocity, S * velocity}, config.stiffness * d * S).z() / config.mass;
    };
    double d = 0.0, v = u0;
    const double dt = 1e-5;
    while (d >= 0.0) {  // classical Runge-Kutta
      const double a1 = acceleration(d, v), v2 = v + 0.5 * dt * a1, a2 = acceleration(d + 0.5 * dt * v, v2);
      const double v3 = v + 0.5 * dt * a2, a3 = acceleration(d + 0.5 * dt * v2, v3);
      const double v4 = v + dt * a3, a4 = acceleration(d + dt * v3, v4);
      d += dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    const double u1 = -v, left = chi * u0 - std::log1p(chi * u0), right = -chi * u1 - std::log1p(-chi * u1);
    // The last step crosses the surface at a depth below dt u1, where the force is below K dt u1. The error of this
    // step is 1e-6 of u1.
    EXPECT_NEAR(left, right, 1e-5 * left) << chi;
    EXPECT_LT(u1, u0);
  }
}

TEST(HuntCrossley, NeverPullsWhileTheToolIsSlowerThanOneOverChiAndKeepsTheLimit) {
  RenderingConfig config;
  config.stiffness = 1000.0;
  config.hunt_crossley = 10.0;
  const Mat3 S = load(Vec3::UnitZ(), 1.0);
  for (const double depth : {1e-6, 1e-3}) {
    const Vec3 spring(0.0, 0.0, -1000.0 * depth), out(0.0, 0.0, -0.099);
    DampingAndLimits stage(config);
    EXPECT_LT(stage.rendered_force(spring, S, {out, S * out}, 1000.0 * depth * S).z(), 0.0);
    EXPECT_NEAR(stage.damping_matrix(spring, S)(2, 2), 10.0 * 1000.0 * depth, 1e-12);
  }
  config.max_damping = 2.0;
  DampingAndLimits limited(config);
  const Vec3 v(0.0, 0.0, 0.1);
  EXPECT_NEAR(limited.rendered_force(Vec3::Zero(), S, {v, S * v}, 1.0 * S).z(), -2.0 * 0.1, 1e-15);
}

}  // namespace
}  // namespace hapbench::force_stage_test
