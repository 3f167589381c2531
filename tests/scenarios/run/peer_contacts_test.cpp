#include "scenarios/run/assemble.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/plugins/load_plugin.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::peer_contacts_test {
namespace {

using test::bundled;

/// On a coarser block than theirs, whose tree is sooner made.
std::vector<std::string> on_block(const std::string& source) {
  return {"rendering.contact_source=" + source, "environment.grid_m=0.0002"};
}

class APeersContacts : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (find_peer(GetParam()) == nullptr)
      GTEST_SKIP() << GetParam() << " is not built here: install " << peer_package(GetParam())
                   << " and configure again";
  }
};
INSTANTIATE_TEST_SUITE_P(All, APeersContacts, testing::ValuesIn(kPeers), [](const auto& peer) { return peer.param; });

TEST_P(APeersContacts, OfAFlatPressedFlatAreItsDepthStraightDown) {
  const Scenario scenario = bundled("poke_on_flat", on_block(GetParam()));
  const auto source = make_peer_source(scenario, NamedFiles(scenario));
  const Cylinder drill = make_cylinder(scenario.tool);
  constexpr double kDeep = 20e-6;
  const Vec3 tip(-0.002, 0.0005, -kDeep);
  ContactBuffer contacts(source->capacity());
  source->contacts_at({tip, -Vec3::UnitZ()}, contacts);
  const double grid = std::get<BlockEnvironment>(scenario.environment).grid;
  std::size_t below = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_GE(contacts.depth[i], 0.0);
    EXPECT_NEAR(contacts.gradient(i).norm(), 1.0, 1e-12);
    // A triangle at the rim leaves sideways by less.
    if ((contacts.point(i) - tip).head<2>().norm() > drill.radius() - 2.0 * grid) continue;
    ++below;
    // FCL's tolerance, and Bullet's margin around the drill, is a micrometre.
    EXPECT_NEAR(contacts.depth[i], kDeep, 1e-6 + 1e-9) << i;
    EXPECT_LT(contacts.gradient(i).z(), -0.999) << i;
  }
  // Two triangles for each square of the grid.
  const double disc = 3.14 * std::pow(drill.radius() - 2.0 * grid, 2);
  EXPECT_GT(static_cast<double>(below), disc / (grid * grid));
  source->contacts_at({{0.0, 0.0, 0.01}, -Vec3::UnitZ()}, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST_P(APeersContacts, FeedARunThatIsTheSameAgain) {
  std::vector<std::string> overrides = on_block(GetParam());
  overrides.insert(overrides.end(), {"time.duration_s=0.02", "rendering.reduction={}"});
  const Scenario scenario = bundled("poke_on_flat", overrides);
  const auto run = [&] {
    Simulation simulation(simulation_config(scenario), assemble(scenario), {});
    EXPECT_EQ(run_to_end(simulation).outcome, Outcome::completes);
    const Vec3 end = simulation.tool().pose.position;
    EXPECT_EQ(simulation.source().fault(), nullptr);
    simulation.reset();
    run_to_end(simulation);
    EXPECT_EQ(simulation.tool().pose.position, end);
    return end;
  };
  EXPECT_EQ(run(), run());
}

/// The message with which `work` is refused; empty when it is not.
template <class Work>
std::string refusal(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ContactSource, IsRefusedWhereAPeerHasNoAnswer) {
  const auto said = [](const std::string& scene, std::vector<std::string> overrides = {}) {
    overrides.emplace_back("rendering.contact_source=bullet");
    const std::string message = refusal([&] { bundled(scene, overrides); });
    const auto start = message.find("/rendering/contact_source");
    return start == message.npos ? message : message.substr(start);
  };
  const std::string start = "/rendering/contact_source: got \"bullet\"; allowed: \"own\", ";
  EXPECT_EQ(said("peg_in_hole_2d_mean"), start + "unless the environment is a block_with_hole or a mesh");
  EXPECT_EQ(said("drag_molar"), start + "unless the tool is a cylinder with a flat tip");
  EXPECT_EQ(said("poke_on_flat", {"tool.tip=round", "record.ideal_trajectory=false"}),
            start + "unless the tool is a cylinder with a flat tip");
  EXPECT_EQ(said("poke_on_flat", {"rendering.local_average=true"}),
            start + "with local_average, which merges shell points");
  EXPECT_EQ(said("poke_on_flat", {"rendering.reduction={\"shuffle_seed\":1}"}),
            start + "with reduction.shuffle_seed, which orders shell points");
  EXPECT_EQ(said("poke_on_flat"), "");
}

TEST(ContactSource, SaysHowToHaveAPeerThatIsNotThere) {
  LoadedScenario loaded;
  loaded.scenario = bundled("poke_on_flat");
  for (const char* peer : kPeers) {
    loaded.scenario.rendering.contact_source = peer;
    const std::string message = refusal([&] { check_named_files(loaded); });
    if (find_peer(peer) != nullptr) {
      EXPECT_EQ(message, "");
    } else {
      EXPECT_NE(message.find("is not built here; allowed: \"own\", or install lib"), message.npos) << message;
    }
  }
  EXPECT_EQ(find_peer("nobody"), nullptr);
}

}  // namespace
}  // namespace hapbench::peer_contacts_test
