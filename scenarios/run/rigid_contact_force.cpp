#include "scenarios/run/rigid_contact_force.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/motions.hpp"
#include "sim/contact/rigid_contact.hpp"

namespace hapbench {
namespace {

using HandSpring = ReferenceForce::HandSpring;

/// Returns the hand's spring if this spring pulls a tool whose position is free. Empty without a hand spring, or if
/// the position is prescribed.
std::optional<HandSpring> leading_hand(const Scenario& scenario) {
  const ImpedanceHandFields* spring = spring_of(scenario.hand);
  if (!position_is_free(scenario.motion) || spring == nullptr) return std::nullopt;
  return HandSpring{spring->target, spring->stiffness};
}

/// Follows the target of `hand`, or the prescribed path if `hand` is empty, and returns the force in every step.
ReferenceForce computed(const Scenario& scenario, const NamedFiles& files, const std::optional<HandSpring>& hand) {
  const auto& tool = std::get<CylinderFields>(scenario.tool);
  RigidContact contact(files.at(kEnvironmentFile).mesh().triangles(), {tool.diameter / 2.0, tool.length});
  const auto motion = make_motion(scenario, files);
  const Vec3 start = hand ? scenario.initial.position : motion->position_at(0.0);
  const SurfaceDistance height = make_solid(scenario, files)->at(start);
  if (height.value <= 0.0 || !contact.start(start, motion->axis_at(0.0))) {
    fail_at(
        "/reference_force",
        fmt::format("type \"rigid_contact\": the tool touches the mesh in the first step ({}); allowed: a path that "
                    "begins outside, because the nearest free position is reached along the path",
                    length_text(height.value)));
  }
  std::vector<ReferenceForce::Sample> samples;
  const double K = hand ? hand->stiffness : scenario.rendering.stiffness;
  for (std::int64_t step = 0; step < scenario.time.steps; ++step) {
    const double time = static_cast<double>(step) * scenario.time.step;
    const Vec3 wanted = hand ? vector_at(hand->target, time) : motion->position_at(time);
    const Vec3 free = contact.follow(wanted, motion->axis_at(time));
    if (contact.touched_far_end()) {
      fail_at("/reference_force",
              fmt::format("type \"rigid_contact\": the tool's far end touches the mesh at {:.4g} s; allowed: a longer "
                          "tool.length_m, or a path on which only tip and side touch",
                          time));
    }
    samples.push_back({time, K * (free - wanted)});
  }
  return ReferenceForce(std::move(samples), K * contact.error(), hand);
}

}  // namespace

std::shared_ptr<const ReferenceForce> rigid_contact_force(const Scenario& scenario, const NamedFiles& files) {
  // Collect the fields that determine the force as the cache key. The force depends on neither law nor damping.
  const Json whole = effective_scenario(scenario, {});
  Json content = {{"mesh", files.at(kEnvironmentFile).hash()}};
  const std::optional<HandSpring> hand = leading_hand(scenario);
  if (!hand) content["stiffness"] = scenario.rendering.stiffness;
  for (const char* field : {"time", "environment", "tool", "motion"}) content[field] = whole.at(field);
  if (hand) content.update({{"hand", whole.at("hand")}, {"initial", whole.at("initial")}});
  const auto bytes = [&scenario](const ReferenceForce&) {
    return sizeof(ReferenceForce::Sample) * static_cast<std::size_t>(scenario.time.steps);
  };
  return shared_cache().get<ReferenceForce>(
      "rigid contact " + content.dump(),
      [&] { return std::make_shared<const ReferenceForce>(computed(scenario, files, hand)); }, bytes);
}

}  // namespace hapbench
