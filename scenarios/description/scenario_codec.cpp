#include "scenarios/description/scenario_codec.hpp"

#include <fmt/format.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/description/device_codec.hpp"
#include "scenarios/description/environment_codec.hpp"
#include "scenarios/description/hand_codec.hpp"
#include "scenarios/description/integrator_codec.hpp"
#include "scenarios/description/motion_codec.hpp"
#include "scenarios/description/outcome_codec.hpp"
#include "scenarios/description/rendering_codec.hpp"
#include "scenarios/description/values.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

std::shared_ptr<ObjectCodec<TimeFields>> time_codec() {
  auto time = object<TimeFields>();
  time->required(
      "step_s", [](auto& t) -> double& { return t.step; }, number({0.0, 1.0, "s", true}), "time step");
  time->deferred(
      "steps", [](auto& t) -> auto& { return t.steps; }, integer(1, static_cast<std::int64_t>(kMostSteps)),
      "number of steps (rows)");
  time->deferred(
      "duration_s", [](auto& t) -> auto& { return t.duration; }, number({0.0, 1e9, "s", true}),
      "instead of steps: duration_s / step_s, rounded");
  time->optional(
      "stop_when", [](auto& t) -> auto& { return t.stop_when; },
      list_of(name_of({"leaves_hole", "tool_horizontal"}, "stop condition"), 0, 2),
      "end early: tip centre above height 0; axis in the horizontal plane");
  time->exactly_one_of("steps", "duration_s");
  return time;
}

std::shared_ptr<ObjectCodec<InitialFields>> initial_codec() {
  auto initial = object<InitialFields>();
  initial->optional(
      "position_m", [](auto& i) -> Vec3& { return i.position; }, vector3({-1000.0, 1000.0, "m"}),
      "tip centre at t = 0; ignored when the motion prescribes it");
  initial->optional(
      "velocity_m_per_s", [](auto& i) -> Vec3& { return i.velocity; }, vector3({-1e6, 1e6, "m/s"}),
      "velocity at t = 0");
  return initial;
}

std::shared_ptr<ObjectCodec<ToolFields>> tool_codec() {
  auto tool = object<ToolFields>();
  tool->deferred(
      "diameter_m", [](auto& t) -> auto& { return t.diameter; }, number({0.0, 1000.0, "m", true}),
      "diameter of the cylinder; default 0.001");
  tool->deferred(
      "length_m", [](auto& t) -> auto& { return t.length; }, number({0.0, 1000.0, "m", true}),
      "from the tip plane to the bottom; default 0.005 in hole_2d, else 0.01");
  tool->deferred(
      "tip", [](auto& t) -> auto& { return t.tip; }, name_of({"flat", "round"}, "tip"),
      "round adds a half ball; default round in hole_2d, else flat");
  return tool;
}

std::shared_ptr<ObjectCodec<DivergenceBounds>> bounds_codec() {
  auto bounds = object<DivergenceBounds>();
  bounds->optional(
      "position_m", [](auto& b) -> double& { return b.position; }, number({0.0, 1e9, "m", true}),
      "a run whose tip centre is further from the origin has diverged");
  bounds->optional(
      "speed_m_per_s", [](auto& b) -> double& { return b.speed; }, number({0.0, 1e12, "m/s", true}),
      "a run whose tool is faster has diverged");
  bounds->optional(
      "force_N", [](auto& b) -> double& { return b.force; }, number({0.0, 1e15, "N", true}),
      "a run whose rendered force is larger has diverged");
  return bounds;
}

std::shared_ptr<ObjectCodec<RecordFields>> record_codec() {
  auto record = object<RecordFields>();
  record->optional(
      "trajectory", [](auto& r) -> bool& { return r.trajectory; }, boolean(), "write trajectory.csv");
  record->optional(
      "every", [](auto& r) -> std::int64_t& { return r.every; }, integer(1, static_cast<std::int64_t>(kMostSteps)),
      "record each N-th step only");
  record->optional(
      "ratio_iterations", [](auto& r) -> auto& { return r.ratio_iterations; }, list_of(integer(0, 100'000), 0, 1000),
      "write ratios.csv after these numbers of shaping iterations");
  record->optional(
      "contacts", [](auto& r) -> bool& { return r.contacts; }, boolean(), "write contacts.csv");
  record->optional(
      "stiffness_tensor", [](auto& r) -> bool& { return r.stiffness_tensor; }, boolean(), "write stiffness_tensor.csv");
  record->optional(
      "timing", [](auto& r) -> bool& { return r.timing; }, boolean(), "time every step and write timing.json");
  record->optional(
      "energy", [](auto& r) -> bool& { return r.energy; }, boolean(), "keep the energy ledger and write energy.csv");
  record->optional(
      "ideal_trajectory", [](auto& r) -> bool& { return r.ideal_trajectory; }, boolean(),
      "block_with_hole only: compare with the ideal trajectory and write ideal_trajectory.csv");
  return record;
}

std::shared_ptr<ObjectCodec<ExpectFields>> expect_codec() {
  auto bound = object<MetricBound>();
  bound->deferred(
      "min", [](auto& b) -> auto& { return b.min; }, number({-1e15, 1e15}), "smallest value allowed");
  bound->deferred(
      "max", [](auto& b) -> auto& { return b.max; }, number({-1e15, 1e15}), "largest value allowed");
  bound->relation([](const MetricBound& b, const std::string& at) {
    if (!(b.min && b.max && *b.min > *b.max)) return;
    throw InputError(InputError::Kind::relation, at,
                     fmt::format("got min {} above max {}; allowed: min <= max", *b.min, *b.max));
  });
  auto metrics = object<ExpectFields>();
  for (const std::string& name : metric_names()) {
    metrics->deferred(
        name, [name](auto& e) -> std::optional<MetricBound>& { return e.metrics[name]; }, CodecPtr<MetricBound>(bound),
        "bounds of this metric of summary.json");
  }
  auto expect = object<ExpectFields>();
  expect->optional(
      "outcome", [](auto& e) -> auto& { return e.outcomes; }, outcomes(), "how the run must end, or a list of ways");
  expect->optional(
      "metrics", [](auto& e) -> ExpectFields& { return e; }, CodecPtr<ExpectFields>(metrics),
      "bounds on the run's metrics");
  return expect;
}

double step_count(const TimeFields& time) {
  return time.steps ? static_cast<double>(*time.steps) : std::round(*time.duration / time.step);
}

double trial_count(const HandFields& hand) {
  const auto* tracking = std::get_if<TrackingHandFields>(&hand);
  return tracking == nullptr ? 1.0
                             : static_cast<double>(tracking->subjects.size()) * static_cast<double>(tracking->trials);
}

void check_sizes(const Scenario& scenario, const std::string& at) {
  const double steps = step_count(scenario.time);
  if (!(steps >= 1.0 && steps <= kMostSteps)) {
    throw InputError(InputError::Kind::relation, member(member(at, "time"), "duration_s"),
                     fmt::format("got {:.3g} steps (duration_s / step_s); allowed: 1 ... {:.0g}", steps, kMostSteps));
  }
  const double rows = steps / static_cast<double>(scenario.record.every);
  if (records_rows(scenario.record) && rows > kMostRows) {
    throw InputError(
        InputError::Kind::relation, member(member(at, "record"), "every"),
        fmt::format("got {:.3g} recorded rows; allowed: at most {:.0g}, record less often or less", rows, kMostRows));
  }
  // Every step of every trial has its time in memory.
  const double timed = steps * trial_count(scenario.hand);
  if (scenario.record.timing && timed > kMostRows) {
    throw InputError(InputError::Kind::relation, member(member(at, "record"), "timing"),
                     fmt::format("got {:.3g} timed steps; allowed: at most {:.0g}", timed, kMostRows));
  }
}

std::shared_ptr<ObjectCodec<Scenario>> make_codec() {
  auto scenario = object<Scenario>();
  scenario->ignored("$schema", "the JSON Schema, for editors");
  scenario->optional(
      "name", [](auto& s) -> std::string& { return s.name; }, text(200), "default: the file's name");
  scenario->optional(
      "description", [](auto& s) -> std::string& { return s.description; }, text(10'000), "what it shows");
  scenario->optional(
      "source", [](auto& s) -> std::string& { return s.source; }, text(1000), "where the numbers come from");
  scenario->optional(
      "seed", [](auto& s) -> std::int64_t& { return s.seed; }, integer(0, std::int64_t{1} << 53),
      "of everything random");
  scenario->required(
      "time", [](auto& s) -> TimeFields& { return s.time; }, CodecPtr<TimeFields>(time_codec()), "time steps");
  scenario->required(
      "environment", [](auto& s) -> Environment& { return s.environment; }, environment_codec(),
      "what the tool touches");
  scenario->optional(
      "initial", [](auto& s) -> InitialFields& { return s.initial; }, CodecPtr<InitialFields>(initial_codec()),
      "state at t = 0");
  scenario->optional(
      "tool", [](auto& s) -> ToolFields& { return s.tool; }, CodecPtr<ToolFields>(tool_codec()), "the tool");
  scenario->optional(
      "motion", [](auto& s) -> MotionFields& { return s.motion; }, motion_codec(), "scripted motion");
  scenario->optional(
      "hand", [](auto& s) -> HandFields& { return s.hand; }, hand_codec(), "who holds the handle");
  scenario->optional(
      "device", [](auto& s) -> DeviceFields& { return s.device; }, device_codec(), "the haptic device");
  scenario->optional(
      "rendering", [](auto& s) -> RenderingFields& { return s.rendering; }, rendering_codec(),
      "how contacts become a force");
  scenario->optional(
      "integrator", [](auto& s) -> IntegratorFields& { return s.integrator; }, integrator_codec(),
      "how forces become motion");
  scenario->optional(
      "bounds", [](auto& s) -> DivergenceBounds& { return s.bounds; }, CodecPtr<DivergenceBounds>(bounds_codec()),
      "where a run counts as diverged");
  scenario->optional(
      "record", [](auto& s) -> RecordFields& { return s.record; }, CodecPtr<RecordFields>(record_codec()),
      "what is written beside the summary");
  scenario->optional(
      "expect", [](auto& s) -> ExpectFields& { return s.expect; }, CodecPtr<ExpectFields>(expect_codec()),
      "what the run must show; each scenario is its own regression test");
  scenario->relation(check_sizes);
  return scenario;
}

}  // namespace

const ObjectCodec<Scenario>& scenario_codec() {
  static const auto codec = make_codec();
  return *codec;
}

Json scenario_schema() {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "hapbench scenario"},
                 {"description", "SI units; every key carries its own. A profile is a scalar function of time."}};
  schema.update(scenario_codec().schema());
  return schema;
}

}  // namespace hapbench
