#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sim/tool/cylinder.hpp"
#include "sim/tool/tool_state.hpp"
#include "tests/support/brick.hpp"
#include "tests/support/fakes.hpp"

/// What the loop makes of the tool's turn about its own axis.
namespace hapbench::roll_test {
namespace {

const double kDt = SimulationConfig{}.dt;

Profile ramp(double start, double rate) {
  return Profile::Shape(Profile::Ramp{start, rate});
}

const Orientation kSpun{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), ramp(0.5, 30.0)};
const Orientation kLed{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), 0.5};

/// Independent of axis and roll.
Mat3 rotation(const Orientation& o, double t) {
  return (Eigen::AngleAxisd(o.azimuth(t), Vec3::UnitZ()) * Eigen::AngleAxisd(o.tilt(t), Vec3::UnitY()) *
          Eigen::AngleAxisd(o.roll(t), -Vec3::UnitZ()))
      .toRotationMatrix();
}

class WantsRoll final : public Observer {
 public:
  bool wants_roll() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override { rows.push_back(record); }
  std::vector<StepRecord> rows;
};

/// Reads the angular velocity, unfiltered, and answers nothing.
class ReadsTurn final : public ForceAlgorithm {
 public:
  void prepare(const Scene&) override {}
  void reset() noexcept override {}
  void compute(const ToolState&, ContactBuffer&, RenderedForce& out) noexcept override { out = {}; }
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return {}; }
  ForceJacobian jacobian() const noexcept override { return {}; }
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return std::numeric_limits<double>::infinity();
  }
};

std::vector<StepRecord> rows_of(std::shared_ptr<const ToolShape> tool, const Orientation& orientation) {
  SimulationParts parts = test::fake_parts(test::weightless);
  parts.tool = std::move(tool);
  parts.algorithm = std::make_unique<ReadsTurn>();
  parts.motion = std::make_unique<ScriptedMotion>(orientation, std::nullopt);
  SimulationConfig config;
  config.steps = 5;
  WantsRoll observer;
  Simulation(config, std::move(parts), {&observer}).run();
  return observer.rows;
}

const auto kCylinder = std::make_shared<const Cylinder>();
const auto kBrick = std::make_shared<const test::Brick>(0.0003, 0.0008, 0.002);

TEST(Roll, IsRecordedOfEveryToolAndInThePoseOfThoseThatAreNotRound) {
  for (const StepRecord& row : rows_of(kCylinder, kSpun)) {
    EXPECT_LE((ToolPose{Vec3::Zero(), row.tool.pose.axis, row.roll}.rotation() - rotation(kSpun, row.time)).norm(),
              1e-14);
    EXPECT_EQ(row.tool.pose.roll, 0.0);
  }
  for (const StepRecord& row : rows_of(kBrick, kSpun)) {
    EXPECT_LE((row.tool.pose.rotation() - rotation(kSpun, row.time)).norm(), 1e-14);
    EXPECT_EQ(row.tool.pose.roll, row.roll);
  }
}

/// Turns of 1e-3 rad are known to 1e-16 / 1e-3.
TEST(Roll, IsInTheAngularVelocityWhereItIsScriptedOrTheToolIsNotRound) {
  const auto expect_whole = [](const std::vector<StepRecord>& rows, const Orientation& script) {
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const Eigen::AngleAxisd turned(
          Mat3(rotation(script, rows[k].time) * rotation(script, rows[k - 1].time).transpose()));
      EXPECT_LE((rows[k].tool.angular_velocity - turned.angle() / kDt * turned.axis()).norm(), 1e-10) << k;
    }
  };
  expect_whole(rows_of(kCylinder, kSpun), kSpun);
  expect_whole(rows_of(kBrick, kSpun), kSpun);
  expect_whole(rows_of(kBrick, kLed), kLed);
  const auto led = rows_of(kCylinder, kLed);
  for (std::size_t k = 1; k < led.size(); ++k) {
    EXPECT_EQ(led[k].tool.angular_velocity, Vec3(turn(led[k - 1].tool.pose.axis, led[k].tool.pose.axis) / kDt));
  }
}

/// Counts who asks for its roll.
class Counting final : public Motion {
 public:
  explicit Counting(int& asked) : asked_(&asked) {}
  Vec3 axis_at(double) const noexcept override { return -Vec3::UnitZ(); }
  double roll_at(double) const noexcept override { return ++*asked_; }
  bool scripts_roll() const noexcept override { return true; }
  bool position_is_free() const noexcept override { return true; }
  Vec3 position_at(double) const noexcept override { return Vec3::Zero(); }

 private:
  int* asked_;
};

TEST(Roll, IsNotComputedUnlessSomebodyReadsIt) {
  const auto asked = [](std::shared_ptr<const ToolShape> tool) {
    int count = 0;
    SimulationParts parts = test::fake_parts(test::weightless);
    parts.tool = std::move(tool);
    parts.motion = std::make_unique<Counting>(count);
    SimulationConfig config;
    config.steps = 5;
    Simulation(config, std::move(parts), {}).run();
    return count;
  };
  EXPECT_EQ(asked(kCylinder), 0);
  EXPECT_GE(asked(kBrick), 5);
}

}  // namespace
}  // namespace hapbench::roll_test
