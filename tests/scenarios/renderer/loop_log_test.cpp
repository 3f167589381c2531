// Tests the functions of hapbench_renderer.h (allocations, threads, floating-point mode, invalid arguments, layout of
// the structures), the log of a haptic loop, and the wrapper for C++.

#include <gtest/gtest.h>

#include <array>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "algorithms/registry.hpp"
#include "device_model/live/hapbench_renderer.hpp"
#include "results/summary/allocations.hpp"
#include "scenarios/renderer/loop_log.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/renderer/haptic_loop.hpp"

namespace hapbench::renderer_test {
namespace {

/// Returns n inputs of a handle that touches, presses, slides, uses the clutch, causes faults and waits.
std::vector<HapbenchInput> busy_inputs(std::size_t n) {
  std::vector<HapbenchInput> inputs(n);
  for (std::size_t i = 0; i < n; ++i) {
    HapbenchInput& in = inputs[i];
    const double t = kPeriod * static_cast<double>(i);
    in.time_ns = 1'000'000'000 + i * 1'000'000 + (i >= n / 2 ? 50'000'000 : 0);
    in.handle = {{0.001 * std::sin(9.0 * t), 0.0005 * std::cos(7.0 * t), 0.0009 + 0.0008 * std::cos(11.0 * t)},
                 {std::cos(0.1 * t), std::sin(0.1 * t), 0.0, 0.0}};
    if (i % 3 == 0) in.has = HAPBENCH_VELOCITY, in.velocity[2] = -0.0088 * std::sin(11.0 * t);
    if (i > n / 4 && i < n / 3) in.has |= HAPBENCH_CLUTCH;
    if (i == 3 * n / 4) in.handle.position[0] = kNaN;
    if (i == 3 * n / 4 + 300) in.has |= HAPBENCH_REARM;
  }
  return inputs;
}

std::vector<HapbenchOutput> outputs_of(const HapbenchSetup& setup, const std::vector<HapbenchInput>& inputs) {
  const Opened renderer = opened(setup);
  std::vector<HapbenchOutput> outputs(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) hapbench_renderer_step(renderer.get(), &inputs[i], &outputs[i]);
  return outputs;
}

TEST(Renderer, AllocatesNothingInACall) {
  const std::vector<HapbenchInput> inputs = busy_inputs(4000);
  for (const std::string& algorithm : algorithm_names()) {
    HapbenchSetup setup = setup_of(kPlane);
    setup.flags = HAPBENCH_TORQUE;
    const std::string override = "rendering.algorithm=" + algorithm;
    const char* const overrides[] = {override.c_str(), "rendering.damping_ratio=0.2",
                                     R"(rendering.friction={"type": "dry", "mu": 0.3})", nullptr};
    setup.overrides = overrides;
    const Opened renderer = opened(setup);
    std::array<std::size_t, 6> calls{};
    const AllocationCount allocations;
    HapbenchOutput output;
    for (const HapbenchInput& input : inputs) ++calls[hapbench_renderer_step(renderer.get(), &input, &output)];
    EXPECT_EQ(allocations.value(), 0u) << algorithm;
    for (const int status : {HAPBENCH_WAITING, HAPBENCH_RAMPING, HAPBENCH_ON, HAPBENCH_FAULT})
      EXPECT_GT(calls[static_cast<std::size_t>(status)], 0u) << algorithm << ", status " << status;
  }
}

TEST(Renderer, TwoInTwoThreadsDoNotDisturbEachOther) {
  const std::vector<HapbenchInput> inputs = busy_inputs(3000);
  const HapbenchSetup one = setup_of(kPlane);
  HapbenchSetup other = one;
  static const char* const kOther[] = {"rendering.algorithm=shaped_stiffness", "rendering.stiffness_N_per_m=900",
                                       nullptr};
  other.overrides = kOther;
  const auto alone = outputs_of(one, inputs), other_alone = outputs_of(other, inputs);
  std::vector<HapbenchOutput> together, other_together;
  {
    const std::jthread first([&] { together = outputs_of(one, inputs); });
    const std::jthread second([&] { other_together = outputs_of(other, inputs); });
  }
  EXPECT_EQ(compare_outputs(alone, together).equal, inputs.size());
  EXPECT_EQ(compare_outputs(other_alone, other_together).equal, inputs.size());
  EXPECT_GT(compare_outputs(alone, other_alone).largest, 0.01);
}

TEST(Renderer, SetsAndRestoresTheFloatingPointMode) {
  const std::vector<HapbenchInput> inputs = busy_inputs(500);
  const auto expected = outputs_of(setup_of(kPlane), inputs);
  std::fesetround(FE_UPWARD);
  const auto upward = outputs_of(setup_of(kPlane), inputs);
  const int rounding = std::fegetround();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(rounding, FE_UPWARD);
  EXPECT_EQ(compare_outputs(expected, upward).equal, inputs.size());
}

TEST(Renderer, AnswersNullArguments) {
  HapbenchOutput output;
  HapbenchInput input{};
  EXPECT_EQ(hapbench_renderer_step(nullptr, &input, &output), static_cast<unsigned>(HAPBENCH_FAULT));
  EXPECT_EQ(output.reason, static_cast<unsigned>(HAPBENCH_NULL_ARGUMENT));
  EXPECT_EQ(norm(output.force), 0.0);
  EXPECT_EQ(hapbench_renderer_step(nullptr, nullptr, nullptr), static_cast<unsigned>(HAPBENCH_FAULT));
  Loop loop(setup_of(kPlane));
  EXPECT_EQ(hapbench_renderer_step(loop.renderer.get(), nullptr, &output), static_cast<unsigned>(HAPBENCH_FAULT));
  EXPECT_EQ(output.reason, static_cast<unsigned>(HAPBENCH_NULL_ARGUMENT));
  hapbench_renderer_close(nullptr);
}

// Checks the layout of version 1. A change of a size or an offset requires a new HAPBENCH_RENDERER_VERSION.
TEST(RendererAbi, IsThatOfVersion1) {
  static_assert(HAPBENCH_RENDERER_VERSION == 1);
  static_assert(sizeof(HapbenchPose3) == 56);
  static_assert(sizeof(HapbenchMount) == 160 && offsetof(HapbenchMount, scale) == 56 &&
                offsetof(HapbenchMount, handle_from_tip) == 64 && offsetof(HapbenchMount, max_force) == 120 &&
                offsetof(HapbenchMount, engage_force) == 152);
  static_assert(sizeof(HapbenchSetup) == 16 + 4 * sizeof(void*) + sizeof(HapbenchMount) &&
                offsetof(HapbenchSetup, scenario) == 16);
  static_assert(sizeof(HapbenchInput) == 168 && offsetof(HapbenchInput, handle) == 8 &&
                offsetof(HapbenchInput, velocity) == 64 && offsetof(HapbenchInput, has) == 160);
  static_assert(sizeof(HapbenchOutput) == 136 && offsetof(HapbenchOutput, set_position) == 48 &&
                offsetof(HapbenchOutput, gain) == 96 && offsetof(HapbenchOutput, call) == 112 &&
                offsetof(HapbenchOutput, limited) == 132);
  EXPECT_EQ(HAPBENCH_FAULT, 5);
  EXPECT_EQ(HAPBENCH_REARM, 32);
}

std::string log_of(const HapbenchSetup& setup, const std::vector<HapbenchInput>& inputs) {
  const Opened renderer = opened(setup);
  std::string text(hapbench_renderer_log_header(renderer.get(), nullptr, 0) + 1, '\0');
  text.resize(hapbench_renderer_log_header(renderer.get(), text.data(), text.size()));
  for (const HapbenchInput& input : inputs) {
    HapbenchOutput output;
    hapbench_renderer_step(renderer.get(), &input, &output);
    std::array<char, HAPBENCH_LOG_ROW_SIZE> row{};
    EXPECT_GT(hapbench_renderer_log_row(&input, &output, row.data(), row.size()), 0u);
    text += row.data();
  }
  return text;
}

TEST(LoopLog, IsReplayedBitForBit) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "loop.csv";
  const std::vector<HapbenchInput> inputs = busy_inputs(4000);
  const std::string text = log_of(setup_of(kPlane), inputs);
  test::write_plainly(file, text);
  const LoopLog log = read_loop_log(file);
  ASSERT_EQ(log.inputs.size(), inputs.size());
  HapbenchSetup setup = setup_of(kPlane);
  EXPECT_EQ(log.setup.mount.max_force, setup.mount.max_force);
  const Opened renderer = opened(setup);
  const std::vector<HapbenchOutput> again = replayed(*renderer, log);
  const ReplayComparison compared = compare_outputs(again, log.outputs);
  EXPECT_EQ(compared.equal, inputs.size()) << "first other: " << compared.first_other;
  // A recorded force that differs in its last bit is detected.
  LoopLog changed = log;
  changed.outputs[100].force[2] = std::nextafter(changed.outputs[100].force[2], 1.0);
  EXPECT_EQ(compare_outputs(again, changed.outputs).first_other, 100u);
}

TEST(LoopLog, RefusesWhatIsNotAWholeLog) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "loop.csv";
  const std::string text = log_of(setup_of(kPlane), busy_inputs(10));
  std::vector<std::string> lines = test::lines_of(text);
  const auto error_with = [&](std::vector<std::string> changed) {
    std::string all;
    for (const std::string& line : changed) all += line + "\n";
    test::write_plainly(file, all);
    try {
      read_loop_log(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing is refused");
  };
  EXPECT_EQ(error_with(lines), "nothing is refused");
  // Logs with other line ends and with a byte order mark are read.
  for (const std::string end : {"\r\n", "\r"}) {
    std::string other = "\xEF\xBB\xBF";
    for (const std::string& line : lines) other += line + end;
    test::write_plainly(file, other);
    EXPECT_EQ(read_loop_log(file).inputs.size(), 10u);
  }
  auto missing = lines;
  missing.erase(missing.begin() + 6);
  EXPECT_NE(error_with(missing).find("line 7: got call 5 where call 4"), std::string::npos) << error_with(missing);
  auto short_row = lines;
  short_row.back().resize(short_row.back().size() / 2);
  EXPECT_NE(error_with(short_row).find("line 12"), std::string::npos) << error_with(short_row);
  auto text_cell = lines;
  text_cell[5].replace(0, 1, "x");
  EXPECT_NE(error_with(text_cell).find("call: got \"x"), std::string::npos) << error_with(text_cell);
  EXPECT_NE(error_with(text_cell).find("allowed: an integer from 0"), std::string::npos) << error_with(text_cell);
  // Faults of the setup have the line of the setup.
  const auto error_with_setup = [&](const std::string& from, const std::string& to) {
    auto edited = lines;
    edited[0].replace(edited[0].find(from), from.size(), to);
    return error_with(edited);
  };
  for (const auto& [from, to, problem] :
       {std::array<std::string, 3>{R"("mode":"impedance")", R"("mode":"impedanse")",
                                   "line 1: mode: got \"impedanse\"; allowed: impedance or admittance"},
        {R"("ramp_s")", R"("ramp")", "line 1: mount of the log: missing field \"ramp_s\""},
        {R"("torque")", R"("more":1,"torque")", "line 1: setup of the log: unknown field \"more\"; allowed: version"},
        {R"("scale":1.0)", R"("scale":0.0)", "line 1: mount.scale: got 0; allowed: a number > 0"}})
    EXPECT_NE(error_with_setup(from, to).find(problem), std::string::npos) << error_with_setup(from, to);
  EXPECT_NE(error_with({"a,b", "1,2"}).find("is not a log"), std::string::npos);
  EXPECT_NE(error_with({lines[0], lines[1]}).find("no calls"), std::string::npos);
}

TEST(RendererInCpp, IsThinOnTheCInterface) {
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  EXPECT_THROW(Renderer(kPlane, mount), std::runtime_error);
  mount.max_force = 3.0;
  Renderer renderer(kPlane, mount, {"time.step_s=0.002"});
  EXPECT_EQ(renderer.period(), 0.002);
  HapbenchInput input{};
  input.handle = {{0, 0, 0.002}, {1, 0, 0, 0}};
  const HapbenchOutput output = renderer.step(input);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_NE(renderer.log_header().find("\"period_s\":0.002"), std::string::npos);
  EXPECT_EQ(Renderer::log_row(input, output).back(), '\n');
}

}  // namespace
}  // namespace hapbench::renderer_test
