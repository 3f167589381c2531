#include "scenarios/run/encounter.hpp"

#include <gtest/gtest.h>

#include "sim/tool/cylinder.hpp"

namespace hapbench::encounter_test {
namespace {

/// A block of 6 x 6 x 7 mm, whose diagonal is 11 mm, and a tool of 10 mm pushed by a hand of constant force.
class EncounterWithBlock : public testing::Test {
 protected:
  EncounterWithBlock() {
    metrics.rows = 1000;
    metrics.steps_in_contact = 49;
    metrics.last_contact = 0.249;
    approach = {0.0, 0.1, 0.0};
    scenario.environment = MeshEnvironment{"bear.off", 0.001, {}, {}};
    scenario.hand = ForceHandFields{};
    scenario.time = {0.0005, 1000, {}};
  }
  Outcome outcome() const { return outcome_of(scenario, {metrics, approach, box, tool}); }
  std::string warning() const {
    return warning_about(scenario, outcome(), {metrics, approach, box, tool}).value_or("no warning");
  }

  Scenario scenario;
  Metrics metrics;
  Approach approach;
  Cylinder tool;
  Box box{Vec3(0, 0, -0.007), Vec3(0.006, 0.006, 0)};
};

TEST_F(EncounterWithBlock, CompletesWhereTheToolTouchedAndStayedNear) {
  EXPECT_EQ(outcome(), Outcome::completes);
  EXPECT_EQ(warning(), "no warning");
  approach.last = 0.0209;  // retracted, by less than box and tool are long
  EXPECT_EQ(outcome(), Outcome::completes);
}

TEST_F(EncounterWithBlock, LostContactWhenTheToolEndedFarAway) {
  approach.last = 0.0211;
  EXPECT_EQ(outcome(), Outcome::lost_contact);
  EXPECT_EQ(warning(),
            "in contact for 4.9 % of the run, last at 0.249 s; ended 21.1 mm away from the environment (6 x 6 x 7 mm: "
            "x 0 ... 6, y 0 ... 6, z -7 ... 0 mm); a hand of constant force goes on pushing where there is no surface");
}

TEST_F(EncounterWithBlock, AScriptMayLeadTheToolAway) {
  scenario.motion.position = PrescribedPosition{};
  approach.last = 1.0;
  EXPECT_EQ(outcome(), Outcome::completes);
}

TEST_F(EncounterWithBlock, NoContactAsksForTheScaleWhereSizesAreOutOfProportion) {
  metrics.steps_in_contact = 0;
  approach.closest = 0.0079;
  EXPECT_EQ(outcome(), Outcome::no_contact);
  EXPECT_EQ(warning().find("scale"), std::string::npos);
  for (const double factor : {1e-3, 1e3}) {
    const Box other{factor * box.min, factor * box.max};
    const auto text = warning_about(scenario, Outcome::no_contact, {metrics, approach, other, tool});
    EXPECT_NE(text.value_or("").find("; is environment.scale right?"), std::string::npos) << factor;
  }
}

TEST_F(EncounterWithBlock, NoContactTellsWhichHandNeverReaches) {
  metrics.steps_in_contact = 0;
  approach.closest = 0.002;
  ImpedanceHandFields hand;
  hand.target[2] = Profile(0.003);
  scenario.hand = hand;
  EXPECT_NE(warning().find("; hand.target stays 3 mm away from it"), std::string::npos) << warning();
  scenario.hand = NoHandFields{};
  EXPECT_NE(warning().find("; nothing pushes the tool"), std::string::npos) << warning();
}

TEST_F(EncounterWithBlock, NoContactOfAStrokeInMillimetresAsksForMetres) {
  metrics.steps_in_contact = 0;
  approach.closest = 1.5;
  scenario.motion.position = RecordedPosition{"stroke.csv"};
  EXPECT_NE(warning().find("; are the positions of motion.position.file in metres?"), std::string::npos) << warning();
}

}  // namespace
}  // namespace hapbench::encounter_test
