#include "results/observe/energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "algorithms/registry.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::energy_test {
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
  double residual_max = 0.0, turnover = 0.0;
  double kinetic_at_start = 0.0, stored_at_start = 0.0;
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
  accounts.residual_max = told(ledger, "residual_max_J").value();
  accounts.turnover = turnover.value;
  return accounts;
}

/// Every joule of a free run is accounted for; a limit is that of an ideal device [N].
void expect_closed(const test::AnalyticScene& scene, const RenderingConfig& config, const IntegratorEntry& integrator,
                   std::optional<double> limit = {}) {
  SCOPED_TRACE(std::string(scene.name) + " " + config.algorithm + " " + integrator.info.name);
  const Setting setting = scene.setting();
  SimulationParts parts = test::free_run(setting, config);
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{1.0, -2.0, 3.0});
  parts.device = std::make_unique<IdealDevice>(limit);
  SimulationConfig run = test::free_run_config(setting, config, 400);
  run.integrator = &integrator;
  const Accounts a = keep_accounts(run, std::move(parts));
  const EnergyBalance& b = a.balance;
  // Every row adds a handful of roundings of the energy that moves, to which other integrators add their own.
  const double rounding =
      400 * 20 * kEpsilon * (a.turnover + (&integrator == &kLeapfrog ? 0.0 : std::abs(b.integration)));
  EXPECT_LE(a.residual_max, rounding);
  EXPECT_NEAR(b.hand + b.actuator, b.input, rounding);
  EXPECT_NEAR(b.kinetic + b.stored,
              a.kinetic_at_start + a.stored_at_start + b.input + b.damping + b.rotation + b.created + b.integration +
                  b.residual,
              rounding);
}

TEST(EnergyLedger, ClosesToRoundingForEveryAlgorithmAndEveryIntegrator) {
  for (const test::AnalyticScene& scene : test::analytic_scenes()) {
    for (const auto& algorithm : algorithms()) {
      RenderingConfig config = test::config_for(algorithm.info->name, scene);
      config.mu_s = 5.0;
      config.mu_f = 10.0;
      expect_closed(scene, config, kLeapfrog, 2.0);
    }
    for (const IntegratorEntry* integrator : kIntegrators)
      expect_closed(scene, test::config_for("shaped_stiffness", scene), *integrator);
  }
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
}  // namespace hapbench::energy_test
