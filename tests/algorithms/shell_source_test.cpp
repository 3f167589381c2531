#include "algorithms/depth/depth_model.hpp"

#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench::shell_source_test {
namespace {

/// Counts how often it is asked, and in how many of these times about contacts.
class CountingModel final : public DepthModel {
 public:
  struct Counts {
    int prepared = 0, reset = 0, evaluated = 0, with_contacts = 0;
  };
  explicit CountingModel(Counts& counts) : counts_(counts) {}

  void prepare(const PointShell&) override { ++counts_.prepared; }
  void reset() noexcept override { ++counts_.reset; }
  void evaluate(const ToolShape&, const ToolPose&, ContactBuffer& contacts) noexcept override {
    ++counts_.evaluated;
    counts_.with_contacts += !contacts.empty();
    contacts.pad();
  }

 private:
  Counts& counts_;
};

const Cylinder kTool;
const ToolPose kPressed{{0.00001, 0.00002, -0.0003}}, kFree{{0.0, 0.0, 1.0}};

class ShellSourceTest : public testing::Test {
 protected:
  ShellSource counting(Skips skips) {
    return {shell, kTool, std::make_unique<ShellQuery>(shell, kTool), std::make_unique<CountingModel>(counts), skips};
  }

  PointShell shell{surface_points(Plane{0.002, 0.0001}), 0.0};
  CountingModel::Counts counts;
};

TEST_F(ShellSourceTest, AnswersThePointsOfTheSearchWithTheDepthsOfTheModel) {
  for (const DepthModelEntry& entry : depth_models()) {
    ShellSource source(shell, kTool, std::make_unique<ShellQuery>(shell, kTool), entry.make());
    ShellQuery query(shell, kTool);
    const auto model = entry.make();
    model->prepare(shell);
    ContactBuffer answered(source.capacity()), expected(query.capacity());
    source.contacts_at(kPressed, answered);
    query.contacts_at(kPressed, expected);
    model->evaluate(kTool, kPressed, expected);
    ASSERT_EQ(answered.size(), expected.size());
    ASSERT_GT(answered.size(), 10u);
    for (std::size_t i = 0; i < answered.size(); ++i) {
      EXPECT_EQ(answered.index[i], expected.index[i]);
      EXPECT_EQ(answered.depth[i], expected.depth[i]);
      EXPECT_EQ(answered.gradient(i), expected.gradient(i));
    }
    EXPECT_EQ(source.work().queries, 1u);
  }
}

TEST_F(ShellSourceTest, TellsTheModelOnceThatThereIsNoContact) {
  for (const Skips skips : {Skips::on, Skips::off}) {
    counts = {};
    ShellSource source = counting(skips);
    EXPECT_EQ(counts.prepared, 1);
    ContactBuffer contacts(source.capacity());
    for (const ToolPose& pose : {kPressed, kFree, kFree, kFree, kPressed, kPressed, kFree}) {
      source.contacts_at(pose, contacts);
    }
    EXPECT_EQ(counts.with_contacts, 3);
    EXPECT_EQ(counts.evaluated, skips == Skips::on ? 5 : 7);
  }
}

TEST_F(ShellSourceTest, ForgetsInAResetThatThereWasNoContact) {
  ShellSource source = counting(Skips::on);
  ContactBuffer contacts(source.capacity());
  source.contacts_at(kFree, contacts);
  source.reset();
  EXPECT_EQ(counts.reset, 1);
  EXPECT_EQ(source.work().queries, 0u);
  source.contacts_at(kFree, contacts);
  EXPECT_EQ(counts.evaluated, 2);
}

}  // namespace
}  // namespace hapbench::shell_source_test
