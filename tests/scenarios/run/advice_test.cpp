#include <gtest/gtest.h>

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "tests/scenarios/run/diagnosed_scene.hpp"

namespace hapbench::advice_test {
namespace {

using test::finding, test::run, test::run_of_text, test::Scene, test::Words;

// Tests that the advice of the diagnosis helps in runs that are simulated, and that it blames nothing without effect.

/// Returns the advice of the rule's finding; "no finding" if the rule finds nothing.
std::string advice(const Result& run, std::string_view rule) {
  const Diagnosed* found = finding(run, rule);
  return found != nullptr ? found->attempt : "no finding";
}

void expect_words(const std::string& text, const Words& with, const Words& without) {
  for (const std::string& word : with) EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
  for (const std::string& word : without) EXPECT_EQ(text.find(word), std::string::npos) << word << " in: " << text;
}

/// The hand of this scene does not react to the handle, so the unstable servo does not move the tool: a run with a
/// stable servo is equal to the last bit. A smaller K is the remedy.
TEST(Advice, DoesNotBlameAServoThatDoesNotMoveTheTool) {
  const Scene scene = {"hole_coarse_step"};
  const Result result = run(scene), with_servo = run({scene.name, {"device.servo.stiffness_N_per_m=4000"}});
  EXPECT_EQ(result.state_hash, with_servo.state_hash);
  EXPECT_EQ(finding(result, "servo"), nullptr);
  EXPECT_NE(finding(result, "edge"), nullptr);
  expect_words(advice(result, "buzz"), {"a smaller K"}, {"servo", "no K helps"});
  const Result softer = run({scene.name, {"rendering.stiffness_N_per_m=10000"}});
  EXPECT_EQ(finding(softer, "buzz"), nullptr);
}

/// The damping of a sampled hand is unstable if B dt / m is above 2. Less damping is the remedy, and more damping is
/// not.
TEST(Advice, BlamesTheDampingOfASampledHand) {
  const auto held = [](const char* device, const char* damping) {
    return run(
        {"poke_plane",
         {fmt::format("device={}", device),
          fmt::format(R"(hand={{"type":"impedance","damping_N_s_per_m":{},"target":{{"x_m":0,"y_m":0,"z_m":-0.001}}}})",
                      damping)}});
  };
  for (const char* device : {R"({"type":"ideal"})", R"({"type":"impedance","handle_mass_kg":0.1})"}) {
    const Result result = held(device, "450");
    expect_words(advice(result, "servo"), {"a hand with less damping"}, {"servo", "delay", "more damping"});
    expect_words(advice(result, "diverged"), {"a hand with less damping"}, {"servo", "delay", "more damping"});
    EXPECT_EQ(finding(held(device, "50"), "servo"), nullptr) << device;
  }
}

/// A hand pushes a tool off the edge of a plane. 9 s later, the tool is beyond the bound of the position. Neither K nor
/// the time step is the cause.
TEST(Advice, DoesNotBlameKForATimeWithoutContact) {
  const Result result = run({"poke_plane",
                             {R"(hand={"type":"push","force_N":2,"angle_rad":0.5})", R"(device={"type":"ideal"})",
                              "time.step_s=0.001", "time.duration_s=30"}});
  ASSERT_EQ(result.end.outcome, Outcome::diverges);
  expect_words(advice(result, "diverged"), {"a hand whose path ends on the surface"}, {"smaller K", "time.step_s"});
}

/// A tool passes between the points of a surface without touching one: K and the force of the hand are not the cause.
TEST(Advice, NamesTheSpacingIfTheToolPassesBetweenThePoints) {
  const auto pressed = [](const char* spacing, const char* K) {
    return run({"poke_plane",
                {R"(hand={"type":"push","force_N":1})", R"(device={"type":"ideal"})", "environment.size_m=0.06",
                 fmt::format("environment.spacing_m={}", spacing), fmt::format("rendering.stiffness_N_per_m={}", K)}});
  };
  // With a spacing of 20 mm, the nearest points are 14 mm away from the tool, which is 1 mm wide.
  for (const char* K : {"2000", "200000"}) {
    const Result result = pressed("0.02", K);
    ASSERT_EQ(result.end.outcome, Outcome::went_through);
    expect_words(advice(result, "sank"), {"a smaller environment.spacing_m (20 mm now)"}, {"larger K", "hand force"});
  }
  EXPECT_EQ(pressed("0.0003", "20000").end.outcome, Outcome::completes) << "the remedy helps";
}

/// A drag whose path ends early is not held by friction: only a longer path helps.
TEST(Advice, NamesTheEndOfTheDragsPath) {
  const auto dragged = [](const char* spacing, const char* speed, const char* friction) {
    return run_of_text(fmt::format(R"({{
      "time": {{"step_s": 0.001, "duration_s": 1}},
      "environment": {{"type": "plane", "size_m": 0.012, "spacing_m": {}}},
      "initial": {{"position_m": [-0.003, 0, 0.0011]}},
      "tool": {{"diameter_m": 0.002, "length_m": 0.02, "tip": "round"}},
      "hand": {{"type": "drag", "force_N": 1, "direction": [1, 0, 0], "speed_m_per_s": {}, "tilt_rad": 0.2}},
      "rendering": {{"algorithm": "shaped_stiffness", "stiffness_N_per_m": 20000, "damping_ratio": 0.7,
                    "friction": {}}}}})",
                                   spacing, speed, friction));
  };
  const char* const none = R"({"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0})";
  const Result result = dragged("0.0008", "0.006", none);
  ASSERT_EQ(result.end.outcome, Outcome::not_dragged);
  expect_words(advice(result, "stuck"), {"a longer path", "short_path"}, {"friction", "stiffer hand", "algorithms"});
  EXPECT_EQ(dragged("0.0004", "0.006", none).end.outcome, Outcome::completes) << "the remedy of the warning helps";
  // Friction can hold the tool on a path that is also too short.
  expect_words(advice(dragged("0.0004", "0.02", R"({"type": "dry", "mu": 5})"), "stuck"), {"rendering.friction"}, {});
}

/// A loop that is unstable at any K has one cause: no rule names K or the force of the hand.
TEST(Advice, NamesTheUnstableLoopInEveryRule) {
  const Result result = run_of_text(R"({
    "time": {"step_s": 0.001, "duration_s": 1.5},
    "environment": {"type": "plane", "size_m": 0.05, "spacing_m": 0.001},
    "initial": {"position_m": [0, 0, 0.0015]},
    "tool": {"diameter_m": 0.01, "length_m": 0.1, "tip": "flat"},
    "hand": {"type": "mass_spring_damper", "mass_kg": 0.1, "stiffness_N_per_m": 300, "damping_N_s_per_m": 3,
             "target": {"x_m": 0, "y_m": 0, "z_m": {"type": "waypoints", "interpolation": "cosine",
                                                    "points": [[0, 0.0015], [0.3, -0.004], [1.5, -0.005]]}}},
    "device": {"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.3, "encoder_step_m": 1e-5,
               "force_max_N": 10, "delay_samples": 6},
    "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 3000, "damping_N_s_per_m": 60,
                  "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  ASSERT_NE(finding(result, "loop"), nullptr);
  ASSERT_NE(finding(result, "saturated"), nullptr);
  ASSERT_NE(finding(result, "energy"), nullptr);
  for (const Diagnosed& found : result.diagnosis.value())
    expect_words(found.attempt, {"a shorter delay of the device"}, {"smaller K", "smaller hand force"});
}

/// An oscillation of a contact that has no damping: more damping is the remedy, and a smaller K is not.
TEST(Advice, NamesTheDampingOfAnUndampedContact) {
  const auto pressed = [](const char* zeta) {
    return run({"poke_plane",
                {R"(hand={"type":"push","force_N":1})", R"(device={"type":"ideal"})",
                 fmt::format("rendering.damping_ratio={}", zeta),
                 R"(rendering.friction={"mu_s_N_s_per_m":0,"mu_f_s_per_m":0})"}});
  };
  expect_words(advice(pressed("0"), "buzz"), {"a larger rendering.damping_ratio", "undamped"}, {"smaller K"});
  EXPECT_EQ(finding(pressed("0.1"), "buzz"), nullptr) << "the remedy helps";
}

/// The force of an encoder step is the rendered damping, with its limit, times the measured velocity of one step. The
/// same motion has the same number, whether 79 contacts or one render the damping.
TEST(Advice, MeasuresTheForceOfAnEncoderStepWithTheRenderedDamping) {
  const auto number = [](const char* damping, const char* limit) {
    const Result result =
        run({"tap_wall",
             {R"(device={"type":"impedance","handle_mass_kg":0.1,"encoder_step_m":3e-5})",
              "rendering.stiffness_N_per_m=3000", fmt::format("rendering.damping_N_s_per_m={}", damping),
              fmt::format("rendering.limits.max_damping_N_s_per_m={}", limit)}});
    const auto* found = finding(result, "encoder");
    return found != nullptr ? found->value : 0.0;
  };
  EXPECT_GT(number("20", "null"), 0.1);
  EXPECT_EQ(number("100", "20"), number("20", "null"));
}

/// A shorter time step does not shorten a delay in seconds. A filter of the velocity has no effect without damping.
TEST(Advice, NamesOnlyRemediesThatHelpTheLoop) {
  const auto edge = [](const char* device, const char* K) {
    return advice(run({"tap_wall",
                       {fmt::format("device={}", device), fmt::format("rendering.stiffness_N_per_m={}", K),
                        "rendering.damping_ratio=0"}}),
                  "edge");
  };
  const auto handle = [](const char* fields) {
    return fmt::format(R"({{"type":"impedance","handle_mass_kg":0.1,{}}})", fields);
  };
  expect_words(edge(handle(R"("delay_s":0.005)").c_str(), "5000"), {"a smaller K", "delay"}, {"time.step_s"});
  expect_words(edge(handle(R"("delay_samples":5)").c_str(), "5000"), {"a smaller K", "time.step_s", "delay"}, {});
  const char* filtered = R"("velocity_filter":{"type":"low_pass","cutoff_Hz":50})";
  expect_words(edge(handle(filtered).c_str(), "20000"), {"a smaller K"}, {"filter"});
}

/// A hand shakes at 40 Hz. The force follows with every law and every K.
TEST(Advice, BlamesTheScriptThatShakesTheHand) {
  const std::string hand =
      R"(hand={"type":"push","force_N":{"type":"sine","mean":1,"amplitude":0.4,"period_s":PERIOD}})";
  const auto shaken = [&](const std::string& period, const char* K) {
    std::string text = hand;
    text.replace(text.find("PERIOD"), 6, period);
    return run({"poke_plane", {text, R"(device={"type":"ideal"})", fmt::format("rendering.stiffness_N_per_m={}", K)}});
  };
  for (const char* K : {"60000", "20000"})
    expect_words(advice(shaken("0.025", K), "buzz"), {"a slower script", "40 Hz"}, {"smaller K", "another algorithm"});
  EXPECT_EQ(finding(shaken("0.25", "60000"), "buzz"), nullptr) << "the remedy helps";
}

/// The number of contacts is proportional to 1 / spacing on the outline of a planar hole: half the spacing halves the
/// number of the rule. The counts of contacts at a spacing of the size of the contact vary by a contact, or 25 %.
TEST(Advice, MeasuresTheSpacingOfAPlanarOutline) {
  const auto number = [](const char* spacing) {
    const Result result = run_of_text(fmt::format(R"({{
      "time": {{"step_s": 0.0005, "steps": 4000}},
      "environment": {{"type": "hole_2d", "width_m": 0.001, "depth_m": 0.005, "mouth_m": 0.02, "spacing_m": {}}},
      "tool": {{"diameter_m": 0.001, "length_m": 0.005, "tip": "round"}},
      "initial": {{"position_m": [0.003, 0.00055, 0]}},
      "hand": {{"type": "impedance", "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
               "target": {{"x_m": {{"type": "ramp", "start": 0.003, "rate_per_s": 0.007}}, "y_m": -0.003, "z_m": 0}}}}
    }})",
                                                  spacing));
    const Diagnosed* found = finding(result, "facets");
    return found != nullptr ? found->value : 0.0;
  };
  const double coarse = number("4e-4");
  EXPECT_GT(coarse, 2.0);
  EXPECT_NEAR(number("2e-4"), coarse / 2.0, 0.25 * coarse / 2.0);
}

}  // namespace
}  // namespace hapbench::advice_test
