#include "results/observe/energy_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "algorithms/registry.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/ideal_device.hpp"
#include "device_model/impedance_device.hpp"
#include "results/observe/passivity_observer.hpp"
#include "tests/results/rows.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::energy_ledger_test {
namespace {

using test::Setting;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Keeps the largest amount of energy that moved, against which rounding is to be measured.
class Turnover final : public Observer {
 public:
  explicit Turnover(const EnergyLedger& ledger) : ledger_(&ledger) {}
  void on_step(const StepRecord&) noexcept override {
    const EnergyBalance& b = ledger_->balance();
    for (const double part : {b.kinetic, b.stored, b.input, b.spring, b.damping, b.rotation}) {
      value = std::max(value, std::abs(part));
    }
  }
  double value = 0.0;

 private:
  const EnergyLedger* ledger_;
};

struct Accounts {
  EnergyBalance balance;
  double created_max = 0.0, residual_max = 0.0;
  double turnover = 0.0;
  double kinetic_at_start = 0.0;
  double stored_at_start = 0.0;
};

/// Runs a setting with the energy ledger.
Accounts keep_accounts(SimulationConfig config, SimulationParts parts) {
  EnergyLedger ledger(config.mass, config.dt, parts.motion->position_is_free(), parts.source->capacity(),
                      *config.integrator);
  Turnover turnover(ledger);
  Simulation simulation(config, std::move(parts), {&ledger, &turnover});
  simulation.step();
  Accounts accounts;
  accounts.kinetic_at_start = ledger.balance().kinetic;
  accounts.stored_at_start = ledger.balance().stored;
  simulation.run();
  accounts.balance = ledger.balance();
  accounts.created_max = told(ledger, "created_max_J").value();
  accounts.residual_max = told(ledger, "residual_max_J").value();
  accounts.turnover = turnover.value;
  return accounts;
}

Setting springs_in_x(std::size_t count) {
  Setting setting;
  setting.springs = SpringSet{std::vector<Vec3>(count, Vec3(1, 0, 0)), true};
  setting.pose.position = {0.003, 0, 0};
  return setting;
}

RenderingConfig rendering(const std::string& algorithm) {
  RenderingConfig config;
  config.algorithm = algorithm;
  return config;
}

TEST(EnergyLedger, LinearSpringsCreateNothing) {
  for (const double damping_ratio : {0.0, 0.3}) {
    const Setting setting = springs_in_x(5);
    RenderingConfig config = rendering("summation");
    config.damping_ratio = damping_ratio;
    const Accounts a = keep_accounts(test::free_run_config(setting, config, 2000), test::free_run(setting, config));
    EXPECT_NEAR(a.stored_at_start, 0.5 * 5 * config.stiffness * 9e-6, 1e-15);
    // Every row adds a handful of roundings of the energy that moves.
    EXPECT_LE(std::abs(a.balance.created), 2000 * 10 * kEpsilon * a.turnover);
    EXPECT_LE(a.created_max, 10 * kEpsilon * a.turnover);
    EXPECT_EQ(a.balance.damping == 0.0, damping_ratio == 0.0);
    EXPECT_LE(a.balance.damping, 0.0);
  }
}

/// Every joule is accounted for.
void expect_closed(const Accounts& a, double rounding) {
  const EnergyBalance& b = a.balance;
  EXPECT_LE(a.residual_max, rounding);
  EXPECT_NEAR(b.hand + b.actuator, b.input, rounding);
  EXPECT_NEAR(b.kinetic + b.stored,
              a.kinetic_at_start + a.stored_at_start + b.input + b.damping + b.rotation + b.created + b.integration +
                  b.residual,
              rounding);
}

TEST(EnergyLedger, ClosesToRoundingForEveryAlgorithmWithTheIdealDevice) {
  for (const auto& algorithm : algorithms()) {
    for (const test::AnalyticScene& scene : test::analytic_scenes()) {
      RenderingConfig config = test::config_for(algorithm.info->name, scene);
      config.mu_s = 5.0;
      config.mu_f = 10.0;
      const Setting setting = scene.setting();
      SimulationParts parts = test::free_run(setting, config);
      parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{1.0, -2.0, 3.0});
      parts.device = std::make_unique<IdealDevice>(2.0);
      const SimulationConfig run = test::free_run_config(setting, config, 400);
      const Accounts a = keep_accounts(run, std::move(parts));
      const double rounding = 400 * 20 * kEpsilon * a.turnover;
      SCOPED_TRACE(std::string(scene.name) + " " + config.algorithm);
      expect_closed(a, rounding);
    }
  }
}

TEST(EnergyLedger, ClosesToRoundingForEveryIntegrator) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const test::AnalyticScene& scene : test::analytic_scenes()) {
      const RenderingConfig config = test::config_for("shaped_stiffness", scene);
      const Setting setting = scene.setting();
      SimulationParts parts = test::free_run(setting, config);
      parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{1.0, -2.0, 3.0});
      SimulationConfig run = test::free_run_config(setting, config, 400);
      run.integrator = integrator;
      const Accounts a = keep_accounts(run, std::move(parts));
      const double rounding = 400 * 20 * kEpsilon * (a.turnover + std::abs(a.balance.integration));
      SCOPED_TRACE(std::string(scene.name) + " " + integrator->info.name);
      expect_closed(a, rounding);
    }
  }
}

TEST(EnergyLedger, ChargesTheIntegratorWithWhatItMakesOfAnUndampedSpring) {
  const Setting setting = springs_in_x(5);
  RenderingConfig config = rendering("summation");
  config.damping_ratio = 0.0;
  const double stored = 0.5 * 5 * config.stiffness * 9e-6;
  for (const IntegratorEntry* integrator : kIntegrators) {
    SimulationConfig run = test::free_run_config(setting, config, 200);
    run.integrator = integrator;
    const EnergyBalance b = keep_accounts(run, test::free_run(setting, config)).balance;
    SCOPED_TRACE(integrator->info.name);
    // Whatever is missing of the energy at the start is the integrator's doing, and nobody else's.
    EXPECT_NEAR(b.integration, b.kinetic + b.stored - stored, 200 * 20 * kEpsilon * stored);
    if (integrator == &kImplicitMidpoint) {
      EXPECT_NEAR(b.integration, 0.0, 200 * 20 * kEpsilon * stored);
    } else if (integrator == &kImplicitEuler) {
      // It keeps 1 / (1 + k) a step, k = 5 K dt^2 / M = 0.125: nothing is left after 200.
      EXPECT_NEAR(b.integration, -stored, 1e-9 * stored);
    }
  }
}

TEST(EnergyLedger, AnAdmittanceDeviceHasABalanceOfItsOwn) {
  const Setting setting = springs_in_x(3);
  const RenderingConfig config = rendering("shaped_stiffness");
  SimulationParts parts = test::free_run(setting, config);
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{Profile::Shape(Profile::Sine{1, 3, 0.1, 0}), 0.5, 0});
  parts.device = std::make_unique<AdmittanceDevice>(AdmittanceDeviceConfig{});
  const Accounts a = keep_accounts(test::free_run_config(setting, config, 2000), std::move(parts));
  const EnergyBalance& b = a.balance;
  ASSERT_TRUE(b.device);
  EXPECT_NE(b.hand, 0.0);
  EXPECT_LT(b.device->dissipated, 0.0);
  EXPECT_NEAR(b.device->stored, b.hand + b.actuator + b.device->dissipated, 1e-12 * (std::abs(b.hand) + 1.0));
  EXPECT_LE(a.residual_max, 2000 * 20 * kEpsilon * a.turnover);
}

/// A script presses an undamped spring and lets it go, over and over. Along a straight force law the trapezoidal rule
/// is exact; where contact begins or ends within a step of length d it is off by at most K d^2 / 8. Nothing is
/// integrated.
TEST(EnergyLedger, OfAPrescribedMotionIsTheWorkAlongTheWay) {
  constexpr double kStep = 0.001, K = 2000.0, kSpeed = 0.03;
  const ContactBuffer none(0);
  for (const double middle : {0.002, 0.0005}) {  // within the surface throughout, in and out
    for (const double phase : {0.1, 0.7, 2.0}) {
      EnergyLedger ledger(0.1, kStep, false, 0);
      PassivityObserver passivity(kStep, false);
      double x = 0.0, stored = 0.0, at_start = 0.0;
      std::size_t switches = 0;
      for (std::uint64_t k = 0; k < 500; ++k) {
        StepRecord row = test::row(k, kStep * static_cast<double>(k), none);
        const double last = x;
        x = middle + 0.001 * std::sin(phase + kSpeed / 0.001 * row.time);
        switches += k > 0 && (last > 0.0) != (x > 0.0);
        row.tool.pose.position.x() = x;
        row.tool.velocity.x() = (x - last) / kStep;
        row.force.spring.x() = row.force.rendered.x() = -K * std::max(x, 0.0);
        row.springs.energy = stored = 0.5 * K * std::pow(std::max(x, 0.0), 2);
        if (k == 0) at_start = stored;
        ledger.on_step(row);
        passivity.on_step(row);
      }
      const EnergyBalance b = ledger.balance();
      const double floor = K * std::pow(kSpeed * kStep, 2) / 8.0 * static_cast<double>(switches) + 1e-15;
      EXPECT_EQ(switches > 0, middle < 0.001);
      EXPECT_NEAR(b.spring, at_start - stored, floor);
      EXPECT_NEAR(b.created, 0.0, floor);
      EXPECT_NEAR(b.integration, 0.0, 1e-15);
      EXPECT_NEAR(passivity.energy().value(), stored, floor);
      EXPECT_LE(passivity.net_created(), floor);
    }
  }
}

/// Without delay, encoder and limits the motors do what is rendered, on the handle's own way: their work is that of the
/// rendering. What holding an undamped spring creates is what the handle has at the end, and passivity sees it.
TEST(EnergyLedger, OfAnImpedanceDeviceSaysWhatHoldingTheForceCreates) {
  constexpr double kStep = 0.001;
  const Setting setting = springs_in_x(3);
  RenderingConfig config = rendering("summation");
  config.stiffness = 1000.0;
  config.damping_ratio = 0.0;
  const double stored = 0.5 * 3 * config.stiffness * 9e-6;
  for (const double viscous : {0.0, 0.4}) {
    SimulationConfig run = test::free_run_config(setting, config, 101);
    run.dt = kStep;
    SimulationParts parts = test::free_run(setting, config);
    ImpedanceDeviceConfig device;
    device.handle_mass = 0.2;
    device.viscous = viscous;
    parts.device = std::make_unique<ImpedanceDevice>(device, kStep);
    EnergyLedger ledger(config.mass, kStep, true, parts.source->capacity());
    PassivityObserver passivity(kStep);
    Simulation(run, std::move(parts), {&ledger, &passivity}).run();
    const EnergyBalance b = ledger.balance();
    const double rounding = 100 * 20 * kEpsilon * 10 * stored;
    ASSERT_TRUE(b.device);
    EXPECT_EQ(b.kinetic, 0.0);
    EXPECT_EQ(b.input, 0.0);
    EXPECT_EQ(b.residual, 0.0);
    EXPECT_EQ(b.hand, 0.0);
    EXPECT_NEAR(b.actuator, b.spring + b.damping, rounding);
    EXPECT_NEAR(b.script, -b.actuator, rounding);
    EXPECT_NEAR(b.device->stored, b.actuator + b.device->dissipated, rounding);
    EXPECT_NEAR(b.stored, stored + b.damping + b.created + b.integration + b.script, rounding);
    EXPECT_NEAR(b.created, 0.0, rounding);
    EXPECT_NEAR(b.integration, b.stored + b.device->stored - b.device->dissipated - stored, rounding);
    // Holding f = -k x over a displacement d creates k d^2 / 2.
    EXPECT_GT(b.integration, 0.05 * stored);
    EXPECT_NEAR(passivity.energy().value(), stored - b.actuator, rounding);
    EXPECT_LT(passivity.energy().value(), b.stored);
  }
}

/// Two unit springs, one of which appears stretched: its energy comes from nowhere.
TEST(EnergyLedger, ReportsTheStepAndTheContactsWhereEnergyAppeared) {
  EnergyLedger ledger(1.0, 0.5, true, 4);
  ContactBuffer contacts(4);
  StepRecord record;
  record.rendered = &contacts;
  const auto row = [&](std::uint64_t step, std::vector<std::uint32_t> indices, double energy) {
    contacts.clear();
    for (const std::uint32_t i : indices) contacts.push(i, Vec3::Zero(), Vec3::UnitZ());
    record.step = step;
    record.time = 0.5 * static_cast<double>(step);
    record.colliding = indices.size() + 10;
    record.springs.energy = energy;
    ledger.on_step(record);
  };
  row(0, {7}, 1.0);
  row(1, {7}, 1.0);
  row(2, {9, 3}, 4.0);
  row(3, {3}, 1.5);
  row(4, {3}, 2.0);
  EXPECT_EQ(ledger.balance().created, 1.0);
  EXPECT_EQ(told(ledger, "created_sum_J"), 3.5);
  EXPECT_EQ(told(ledger, "created_max_J"), 3.0);
  const auto events = ledger.events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].step, 2u);
  EXPECT_EQ(events[0].time, 1.0);
  EXPECT_EQ(events[0].created, 3.0);
  EXPECT_EQ(events[0].rendered_before, 1u);
  EXPECT_EQ(events[0].rendered_after, 2u);
  EXPECT_EQ(events[0].colliding_before, 11u);
  EXPECT_EQ(events[0].colliding_after, 12u);
  EXPECT_EQ(events[0].appeared, 2u);
  EXPECT_EQ(events[0].vanished, 1u);
  EXPECT_EQ(events[1].step, 4u);
  EXPECT_EQ(events[1].appeared, 0u);
}

/// A spring whose far end stays while the tool turns: what the turn stores is the rotation's, not created.
TEST(EnergyLedger, TurningTheToolPutsEnergyIntoTheSprings) {
  EnergyLedger ledger(1.0, 0.1, true, 1);
  ContactBuffer contacts(1);
  StepRecord record;
  record.rendered = &contacts;
  constexpr double kTorsion = 4.0;  // [N m] of a spring whose moment grows with the angle
  for (int k = 0; k <= 10; ++k) {
    const double angle = 0.1 * k;
    record.step = static_cast<std::uint64_t>(k);
    record.tool.pose.axis = {std::sin(angle), 0, -std::cos(angle)};  // turns about -y
    record.springs.moment = {0, kTorsion * angle, 0};
    record.springs.energy = 0.5 * kTorsion * angle * angle;
    ledger.on_step(record);
  }
  EXPECT_NEAR(ledger.balance().rotation, 2.0, 1e-14);
  EXPECT_NEAR(ledger.balance().created, 0.0, 1e-14);
}

TEST(EnergyLedger, KeepsTheLargestEventsInOrder) {
  EnergyLedger ledger(1.0, 0.5, true, 1);
  ContactBuffer contacts(1);
  StepRecord record;
  record.rendered = &contacts;
  double energy = 0.0;
  for (int k = 0; k < 50; ++k) {
    energy += (k * 37) % 50;  // every step another amount, 0 … 49 mixed
    record.step = static_cast<std::uint64_t>(k);
    record.springs.energy = energy;
    ledger.on_step(record);
  }
  const auto events = ledger.events();
  ASSERT_EQ(events.size(), EnergyLedger::kEvents);
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].created, 49.0 - static_cast<double>(i));
}

}  // namespace
}  // namespace hapbench::energy_ledger_test
