#include <gtest/gtest.h>

#include <fstream>

#include "algorithms/registry.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/bundled.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::contacts_test {
namespace {

namespace fs = std::filesystem;
using test::bundled;
using test::rows_of;

// Tests runs with multi-rate contacts, with contacts from a file, and with contacts from a library of the user.

using Rows = std::vector<StepRecord>;

void expect_same_bits(const Rows& a, const Rows& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].tool.pose.position, b[k].tool.pose.position) << k;
    ASSERT_EQ(a[k].force.rendered, b[k].force.rendered) << k;
  }
}

std::vector<std::string> late(std::int64_t every, std::int64_t delay, const char* between) {
  return {"rendering.contacts.every=" + std::to_string(every),
          "rendering.contacts.delay_samples=" + std::to_string(delay),
          std::string("rendering.contacts.between=") + between};
}

// Checks contacts of a plane with `between` "linear": between two queries, the depths of the contacts are changed by
// the motion of the tool. The spring forces must equal the forces of a run that finds its contacts in every step.

TEST(LinearContacts, OfAPlaneAreFreshForEveryAlgorithm) {
  // The tool is in contact from step 6 on, and the contacts found in step 7 are used from step 11 on.
  constexpr std::size_t kInContact = 11;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    const std::vector<std::string> pressed = {"rendering.algorithm=" + std::string(algorithm.info->name),
                                              // This model measures the depth along the normal. With other models, the
                                              // depths of points at the rim of the tip do not follow the tool.
                                              "rendering.depth_model=normal_projection", R"(hand={"type":"none"})",
                                              "time.duration_s=0.05",
                                              R"(motion.position={"type":"prescribed","x_m":0,"y_m":0,
           "z_m":{"type":"ramp","start":1e-6,"rate_per_s":-4e-4}})"};
    auto overrides = late(7, 4, "linear");
    overrides.insert(overrides.end(), pressed.begin(), pressed.end());
    const auto fresh = rows_of(bundled("poke_plane", pressed)), linear = rows_of(bundled("poke_plane", overrides));
    ASSERT_EQ(fresh.size(), linear.size());
    // True if depths are measured along the normal. False for depth models with a memory and for depth models that
    // measure the distance to the nearest side of the object.
    const bool depths_are_the_normals =
        algorithm.fixed_depth_model.empty() || algorithm.fixed_depth_model == "normal_projection";
    for (std::size_t k = 0; k < fresh.size(); ++k) {
      if (k < 4) {
        EXPECT_EQ(linear[k].force.spring, Vec3(Vec3::Zero()));
      } else if (k >= kInContact && depths_are_the_normals) {
        // The iterative solvers of the laws end with an error of at most 1e-6 times the force.
        ASSERT_NEAR((linear[k].force.spring - fresh[k].force.spring).norm(), 0.0, 1e-6 * fresh[k].force.spring.norm())
            << k;
      }
    }
  }
}

/// Checks multi-rate contacts that are found in every step. A dropout probability of 1e-300 switches the holding of
/// contacts on, although in practice no query is ever lost.
TEST(MultiRateContacts, OfEveryRowChangeNoBitForAnyAlgorithm) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    const std::vector<std::string> law = {"rendering.algorithm=" + std::string(algorithm.info->name),
                                          "time.duration_s=0.2", "rendering.angular_damping=true"};
    auto none = law, held = law;
    none.emplace_back("rendering.contacts={}");
    held.emplace_back("rendering.contacts.dropout=1e-300");
    const auto fresh = rows_of(bundled("drag_molar", law));
    const Scenario defaults = bundled("drag_molar", none);
    EXPECT_EQ(assemble(defaults).source->schedule(), nullptr);
    expect_same_bits(fresh, rows_of(defaults));
    expect_same_bits(fresh, rows_of(bundled("drag_molar", held)));
  }
}

// Fixture of tests with contacts from a trace.

class Trace : public testing::Test {
 protected:
  LoadedScenario loaded(const std::string& scene, const std::vector<std::string>& overrides) {
    return load_scenario(find_scenario(scene), overrides);
  }
  const test::TemporaryDirectory folder_;
  const fs::path directory_ = folder_.path();
};

TEST_F(Trace, OfARunGivesItsForcesBitForBit) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    if (!algorithm.reported_depth_model.empty()) continue;  // the algorithm finds its points itself
    // A trace does not depend on the law, so other tools and motions are tested with one law.
    std::vector<const char*> scenes = {"plane_wiped_round"};
    if (std::string_view(algorithm.info->name) == "shaped_stiffness")
      scenes.insert(scenes.end(), {"cone_in_cone", "stroke_in_hole"});
    for (const char* scene : scenes) {
      SCOPED_TRACE(testing::Message() << scene << " " << algorithm.info->name);
      std::vector<std::string> overrides = {"rendering.algorithm=" + std::string(algorithm.info->name),
                                            "rendering.damping_ratio=0.7", "time.steps=200"};
      if (algorithm.may_reduce) overrides.emplace_back("rendering.reduction={}");
      overrides.emplace_back("record.contacts=true");
      const fs::path first = directory_ / "first", again = directory_ / "again";
      run_scenario(checked(loaded(scene, overrides)), first, false);
      overrides.emplace_back(R"(rendering.contact_source={"type":"trace","file":")" +
                             (first / "contact_trace.csv").string() + "\"}");
      run_scenario(checked(loaded(scene, overrides)), again, false);
      EXPECT_EQ(test::read_file(first / "trajectory.csv"), test::read_file(again / "trajectory.csv"));
      EXPECT_EQ(test::read_file(first / "contact_trace.csv"), test::read_file(again / "contact_trace.csv"));
    }
  }
}

// ---- Contacts from a library

TEST(ContactPlugin, OfASphereGivesTheForceOfASphere) {
  const ModulePermission permission(true);
  const std::string source = R"(rendering.contact_source={"type":"plugin","file":")" HAPBENCH_TEST_MODULES
                             R"(/sphere.so","config":{"radius_m":0.002}})";
  const Scenario scenario =
      bundled("plane_wiped_round",
              {source, "rendering.friction.mu_s_N_s_per_m=0", "rendering.friction.mu_f_s_per_m=0",
               R"(motion.position={"type":"prescribed","x_m":{"type":"ramp","start":-0.001,"rate_per_s":0.002},)"
               R"("y_m":0,"z_m":0.0024})"});
  const auto rows = rows_of(scenario);
  std::size_t in_contact = 0;
  for (const StepRecord& row : rows) {
    const double depth = std::max(0.0, 0.0025 - row.tool.pose.position.norm());
    in_contact += static_cast<std::size_t>(depth > 0.0);
    const Vec3 force = 20000.0 * depth * row.tool.pose.position.normalized();
    ASSERT_TRUE(row.force.rendered.isApprox(force, 1e-12) || (row.force.rendered - force).norm() < 1e-12)
        << row.tool.pose.position;
  }
  EXPECT_GT(in_contact, 500u);
}

/// Checks that the code of a library that the user has not allowed is not executed, not even for a check.
TEST(ContactPlugin, IsRefusedWithoutPermission) {
  const std::string file = HAPBENCH_TEST_MODULES "/sphere.so";
  const auto named = [](const std::string& library) {
    const std::vector<std::string> overrides{R"(rendering.contact_source={"type":"plugin","file":")" + library +
                                             R"(","config":{"radius_m":0.002}})"};
    return load_scenario(find_scenario("plane_wiped_round"), overrides);
  };
  for (const Libraries use : {Libraries::loaded, Libraries::inspected}) {
    const auto error = test::input_error_of([&] { checked(named(file), use); });
    ASSERT_TRUE(error);
    EXPECT_NE(std::string(error->what()).find("allowed: with --module "), std::string::npos) << error->what();
  }
  EXPECT_THROW(assemble(named(file).scenario), InputError);
  const ModulePermission none(false);
  EXPECT_THROW(checked(named(file)), InputError);
  const ModulePermission all(true);
  checked(named(file), Libraries::inspected);
  checked(named(file));
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "text.so") << "no library";
  const auto error =
      test::input_error_of([&] { checked(named((directory / "text.so").string()), Libraries::inspected); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("is not a shared library"), std::string::npos) << error->what();
}

TEST(ContactPlugin, NamesWhatItMisses) {
  const ModulePermission permission(true);
  const auto message = [](const std::string& file, const std::string& config) -> std::string {
    try {
      assemble(bundled("plane_wiped_round", {"rendering.contact_source={\"type\":\"plugin\",\"file\":\"" + file +
                                             "\",\"config\":" + config + "}"}));
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  const std::string folder = HAPBENCH_TEST_MODULES "/";
  EXPECT_EQ(message(folder + "sphere.so", "{\"radius\":1}"),
            "sphere (sphere.so) fails in create: its config has no number radius_m");
  EXPECT_NE(message(folder + "none.so", "{}").find("cannot be loaded as a module: No such file"), std::string::npos);
  EXPECT_NE(message(folder + "depth_weighted.so", "{}")
                .find("holds a law, not a source of contacts; name it in --module and"),
            std::string::npos);
  EXPECT_NE(message(folder + "sphere.so", "3").find("config: got 3; allowed: an object"), std::string::npos);
}

// Tests that a run that skips unnecessary work and a run that skips nothing (Skips::off) write the same bytes, except
// the work counters. tests/scenarios/program/bundled_scenarios_test.cpp tests this for the bundled scenarios.

/// Returns summary.json without the work counts, as text, so that every digit is compared. Writes the work counts to
/// `work`.
std::string summary_without_work(const fs::path& file, Json& work) {
  Json summary = Json::parse(test::read_file(file));
  work = summary["work"];
  summary.erase("work");
  return summary.dump();
}

class WithAndWithoutSkips : public testing::Test {
 protected:
  void expect_same_results(const Json& scenario) {
    LoadedScenario loaded = read_scenario(scenario, directory_.path());
    const fs::path taken = directory_ / "taken", off = directory_ / "off";
    for (const fs::path& old : {taken, off}) fs::remove_all(old);
    run_scenario(checked(loaded), taken, false);
    loaded.scenario.rendering.skips = Skips::off;
    run_scenario(checked(loaded), off, false);
    test::expect_same_files(taken, off, {"summary.json", "timing.json"});
    Json work_taken, work_off;
    EXPECT_EQ(summary_without_work(taken / "summary.json", work_taken),
              summary_without_work(off / "summary.json", work_off));
    EXPECT_EQ(work_off["steps_skipped"], 0);
    EXPECT_EQ(work_off["lists_rebuilt"], 0);
    EXPECT_EQ(work_off["allocations"], work_taken["allocations"]);
    skipped_ += work_taken["steps_skipped"].get<std::uint64_t>();
  }

  test::TemporaryDirectory directory_;
  std::uint64_t skipped_ = 0;
};

// Checks a motion through free air, contact and free air again, for every algorithm with and without friction.
TEST_F(WithAndWithoutSkips, EveryAlgorithmGivesTheSameBytes) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const char* friction : {"0", "5"}) {
      SCOPED_TRACE(std::string(algorithm.info->name) + " with friction " + friction);
      Json json = Json::parse(std::string(R"({
          "time": {"step_s": 0.0005, "steps": 600}, "environment": {"type": "hole_2d"},
          "initial": {"position_m": [0.0001, 0.001, 0], "velocity_m_per_s": [0, -0.05, 0]},
          "motion": {"orientation": {"tilt_rad": {"type": "ramp", "start": 0.3, "rate_per_s": -1}}},
          "hand": {"type": "force", "y_N": {"type": "sine", "mean": 0, "amplitude": 2, "period_s": 0.1}},
          "record": {"contacts": true},
          "rendering": {"friction": {"mu_s_N_s_per_m": )") +
                              friction + R"(, "mu_f_s_per_m": )" + friction + "}}}");
      json["rendering"]["algorithm"] = algorithm.info->name;
      expect_same_results(json);
    }
  }
  EXPECT_GT(skipped_, 0u);
}

}  // namespace
}  // namespace hapbench::contacts_test
