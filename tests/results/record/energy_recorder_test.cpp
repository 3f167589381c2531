#include "results/record/energy_recorder.hpp"

#include <gtest/gtest.h>

#include "results/allocations/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::energy_recorder_test {
namespace {

using test::read_file;
using test::TemporaryDirectory;

TEST(EnergyRecorder, WritesTheBalanceOfTheRowsItKeeps) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  EnergyLedger ledger(2.0, 0.5, true, 1);
  EnergyRecorder recorder(dir / "energy.csv", 2, ledger);
  for (std::uint64_t k = 0; k < 3; ++k) {
    StepRecord r = test::row(k, 0.5 * static_cast<double>(k), none);
    r.tool.velocity = {static_cast<double>(k), 0, 0};
    r.tool.pose.position.setZero();
    r.force = {};
    r.hand_force = {6, 0, 0};  // pushes with 6 N, of which 4 N get through to 2 kg: 1 m/s more every half second
    r.hand.input = {4, 0, 0};
    r.springs.energy = 0.25;
    r.device.reset();
    ledger.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  EXPECT_EQ(read_file(dir / "energy.csv"), header_of(EnergyRecorder::kColumns) +
                                               "\n0,0,0,0.25,0,0,0,0,0,0,0,0,0,0,,"
                                               "\n2,1,4,0.25,4,0,0,0,0,0,0,0,6,-2,,\n");
}

TEST(EnergyRecorder, FillsTheDeviceColumnsOfADeviceWithMechanics) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  EnergyLedger ledger(2.0, 0.5, true, 1);
  EnergyRecorder recorder(dir / "energy.csv", 1, ledger);
  for (std::uint64_t k = 0; k < 2; ++k) {
    StepRecord r = test::row(k, 0.0, none);
    r.device = DeviceEnergy{3.0, 2.0, -1.0, 4.0};
    ledger.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  EXPECT_TRUE(test::lines_of(read_file(dir / "energy.csv"))[2].ends_with(",3,2,-1,4"));
}

TEST(EnergyRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  EnergyLedger ledger(2.0, 0.5, true, 100);
  EnergyRecorder recorder(dir / "energy.csv", 1, ledger);
  StepRecord r = test::row(0, 0.0, contacts);
  const std::size_t before = heap_allocations();
  for (int k = 0; k < 100; ++k) {
    r.springs.energy += k;  // an event every step
    ledger.on_step(r);
    recorder.on_step(r);
  }
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::energy_recorder_test
