#include "algorithms/peers/peer_source.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "algorithms/registry.hpp"
#include "tests/bench/peers/contact_library.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::peer_source_test {
namespace {

constexpr double kLength = 0.01;

struct Script {
  std::vector<HapbenchContact> answer;
  int asked = 0;
  int throws_at = -1;
  HapbenchPose pose = {};
};
Script script;

/// A library whose sources give the answer in `script`, or throw.
struct FakePeer {
  FakePeer(const HapbenchSurface& surface, const HapbenchTool&) {
    if (surface.triangle_count == 0) throw std::runtime_error("nothing there");
  }
  std::size_t contacts_at(const HapbenchPose& pose, std::span<HapbenchContact> room) {
    script.pose = pose;
    if (script.asked++ == script.throws_at) throw std::runtime_error("no\nway");
    std::copy(script.answer.begin(), script.answer.end(), room.begin());
    return script.answer.size();
  }
};

const HapbenchContactSource kFake = contact_library<FakePeer>("fake");

std::unique_ptr<PeerSource> source_of(Script what) {
  script = std::move(what);
  const PeerSurface ten_triangles{{}, std::vector<std::uint32_t>(30)};
  return std::make_unique<PeerSource>(kFake, "{}", ten_triangles, HapbenchTool{.radius = 0.001, .length = kLength}, 10);
}

TEST(PeerSource, TakesPointDepthAndDirectionAsTheyAre) {
  const auto source = source_of({{{7, {1, 2, 3}, {0, 0, -1}, 0.5}, {8, {4, 5, 6}, {1, 0, 0}, 0.0}}});
  ContactBuffer contacts(source->capacity());
  source->contacts_at({}, contacts);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts.index[0], 7u);
  EXPECT_EQ(contacts.point(0), Vec3(1, 2, 3));
  EXPECT_EQ(contacts.gradient(0), Vec3(0, 0, -1));
  EXPECT_EQ(contacts.normal(0), Vec3(0, 0, 1));
  EXPECT_EQ(contacts.depth[0], 0.5);
  EXPECT_EQ(contacts.largest_depth(), 0.5);
  EXPECT_EQ(source->work().queries, 1u);
  EXPECT_EQ(source->fault(), nullptr);
}

TEST(PeerSource, AsksAboutTheMiddleOfTheDrillWithItsShankAlongZ) {
  const auto source = source_of({});
  ContactBuffer contacts(source->capacity());
  const Vec3 axis = Vec3(1, 2, -3).normalized();
  source->contacts_at({{0.1, 0.2, 0.3}, axis}, contacts);
  const auto& [tip, centre, r] = script.pose;
  EXPECT_EQ(Vec3::Map(tip), Vec3(0.1, 0.2, 0.3));
  EXPECT_TRUE(Vec3(centre[0], centre[1], centre[2]).isApprox(Vec3(0.1, 0.2, 0.3) - 0.5 * kLength * axis, 1e-15));
  EXPECT_TRUE(Vec3(r[2], r[5], r[8]).isApprox(-axis, 1e-15));
}

TEST(PeerSource, SaysWhyALibraryCannotMakeIt) {
  try {
    const PeerSource source(kFake, "{}", {}, {.radius = 0.001, .length = kLength}, 10);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "fake fails: nothing there");
  }
}

/// A library in C, which nothing filters, that gives one contact, or says that it gives more than there is room for.
TEST(PeerSource, RefusesContactsThatCannotBeUsed) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static HapbenchContact answer;
  static std::int64_t count;
  HapbenchContactSource library = kFake;
  library.contacts_at = [](void*, const HapbenchPose*, HapbenchContact* contacts, std::size_t, char*, std::size_t) {
    contacts[0] = answer;
    return count;
  };
  const PeerSurface triangle{{}, std::vector<std::uint32_t>(3)};
  PeerSource source(library, "{}", triangle, {.radius = 0.001, .length = kLength}, 10);
  const auto fault_of = [&](const HapbenchContact& contact, std::int64_t n = 1) -> std::string {
    answer = contact, count = n;
    ContactBuffer contacts(source.capacity());
    source.reset();
    source.contacts_at({}, contacts);
    EXPECT_EQ(contacts.size(), source.fault() == nullptr ? static_cast<std::size_t>(n) : 0u);
    return source.fault() == nullptr ? "" : source.fault();
  };
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, 0.0}), "");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1.0009}, 1.0}), "");
  EXPECT_EQ(fault_of({0, {1, 2, kInfinity}, {0, 0, -1}, 1.0}), "fake fails: a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -kInfinity}, 1.0}), "fake fails: a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, kInfinity}), "fake fails: a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1.002}, 1.0}), "fake fails: a contact whose gradient is no unit vector");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, 0}, 1.0}), "fake fails: a contact whose gradient is no unit vector");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, -1e-9}), "fake fails: a contact with a negative depth");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, 1.0}, 11), "fake fails: gives 11 contacts; allowed: at most 10");
}

TEST(PeerSource, EndsTheRunWhenTheLibraryThrows) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const bool controlled : {false, true}) {
      test::Setting setting;
      setting.springs.emplace();
      RenderingConfig config;
      config.algorithm = algorithm.info->name;
      config.passivity_controller = controlled;
      config.max_force = 1.0;
      config.reduction.emplace();
      SimulationParts parts = test::free_run(setting, config);
      parts.source = source_of({.answer = {{0, {}, {0, 0, -1}, 1e-5}, {1, {}, {1, 0, 0}, 1e-5}}, .throws_at = 3});
      Simulation simulation(test::free_run_config(setting, config, 10), std::move(parts), {});
      const SimulationResult result = simulation.run();
      EXPECT_EQ(result.outcome, Outcome::diverges) << algorithm.info->name << controlled;
      EXPECT_EQ(result.divergence.step, 3u);
      EXPECT_EQ(result.divergence.fault, "fake fails: no way");
      EXPECT_EQ(script.asked, 4);
      simulation.reset();
      script.throws_at = -1;
      EXPECT_EQ(simulation.run().outcome, Outcome::completes);
    }
  }
}

}  // namespace
}  // namespace hapbench::peer_source_test
