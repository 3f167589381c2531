#include "scenarios/description/hand_codec.hpp"

#include "scenarios/description/object.hpp"
#include "scenarios/description/profile_codec.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

constexpr NumberRange kCoordinate = {-1000.0, 1000.0, "m"};

std::shared_ptr<ObjectCodec<ForceHandFields>> force_codec() {
  auto force = object<ForceHandFields>();
  force->optional(
      "x_N", [](auto& f) -> Profile& { return f.force[0]; }, profile("N"), "force on the handle over time");
  force->optional(
      "y_N", [](auto& f) -> Profile& { return f.force[1]; }, profile("N"), "force on the handle over time");
  force->optional(
      "z_N", [](auto& f) -> Profile& { return f.force[2]; }, profile("N"), "force on the handle over time");
  return force;
}

std::shared_ptr<ObjectCodec<ImpedanceHandFields>> impedance_codec() {
  using Target = std::array<Profile, 3>;
  auto target = object<Target>();
  target->required(
      "x_m", [](auto& t) -> Profile& { return t[0]; }, profile("m"), "over time");
  target->required(
      "y_m", [](auto& t) -> Profile& { return t[1]; }, profile("m"), "over time");
  target->required(
      "z_m", [](auto& t) -> Profile& { return t[2]; }, profile("m"), "over time");
  auto impedance = object<ImpedanceHandFields>();
  impedance->optional(
      "stiffness_N_per_m", [](auto& h) -> double& { return h.stiffness; }, number({0.0, 1e9, "N/m"}),
      "of the spring from target to handle");
  impedance->optional(
      "damping_N_s_per_m", [](auto& h) -> double& { return h.damping; }, number({0.0, 1e9, "N s/m"}),
      "of the damper beside it");
  impedance->required(
      "target", [](auto& h) -> Target& { return h.target; }, CodecPtr<Target>(target),
      "where the hand wants the handle");
  return impedance;
}

std::shared_ptr<ObjectCodec<TargetRules>> task_codec() {
  auto task = object<TargetRules>();
  task->optional(
      "display", [](auto& t) -> TargetDisplay& { return t.display; },
      choice<TargetDisplay>({{"panel", TargetDisplay::panel}, {"height", TargetDisplay::height}}, "display"),
      "panel: x and y count, the orientation is scripted; height: z counts, the hand turns the tool");
  task->required(
      "places_m", [](auto& t) -> auto& { return t.places; }, list_of(vector3(kCoordinate), 1, 100),
      "where targets appear");
  task->optional(
      "targets_per_place", [](auto& t) -> std::uint64_t& { return t.targets_per_place; },
      integer_as<std::uint64_t>(1, 1000), "in one trial");
  task->optional(
      "tolerance_m", [](auto& t) -> double& { return t.tolerance; }, number({0.0, 1.0, "m", true}),
      "the tip is on the target within this distance");
  task->optional(
      "least_press_N", [](auto& t) -> double& { return t.least_press; }, number({0.0, 1000.0, "N"}),
      "model force along +z that activates the task");
  task->optional(
      "hold_s", [](auto& t) -> double& { return t.hold; }, number({0.0, 1000.0, "s", true}),
      "time on the target, without a break, that removes it");
  task->optional(
      "time_limit_s", [](auto& t) -> double& { return t.time_limit; }, number({0.0, 1000.0, "s", true}),
      "from the activation until the target disappears");
  return task;
}

std::shared_ptr<ObjectCodec<Subject>> subject_codec() {
  struct Field {
    const char* name;
    double Subject::*member;
    NumberRange range;
    const char* doc;
  };
  static constexpr Field kFields[] = {
      {"reaction_delay_s", &Subject::reaction_delay, {0.0, 10.0, "s"}, "from the display to the hand"},
      {"bandwidth_Hz", &Subject::bandwidth, {0.0, 100.0, "Hz"}, "of following the target on the display"},
      {"stiffness_N_per_m", &Subject::stiffness, {1.0, 1e6, "N/m"}, "of the hand about its intended position"},
      {"damping_N_s_per_m", &Subject::damping, {0.0, 1e6, "N s/m"}, "of the hand"},
      {"press_N", &Subject::press, {0.0, 1000.0, "N"}, "force the subject wants to see on the gauge"},
      {"press_bandwidth_Hz", &Subject::press_bandwidth, {0.0, 100.0, "Hz"}, "of correcting it"},
      {"motor_noise_N", &Subject::motor_noise, {0.0, 1000.0, "N"}, "standard deviation of each force component"},
      {"tilt_noise_rad",
       &Subject::tilt_noise,
       {0.0, 1.0, "rad"},
       "standard deviation of the tilt, where the wrist turns the tool"},
      {"noise_bandwidth_Hz", &Subject::noise_bandwidth, {0.0, 1e4, "Hz"}, "of both noises, first order"},
      {"height_per_tilt_m_per_rad",
       &Subject::height_per_tilt,
       {1e-6, 1.0, "m/rad"},
       "how much the subject expects the tip to rise with the tilt"},
      {"max_speed_m_per_s", &Subject::max_speed, {0.0, 100.0, "m/s"}, "of the intended position"},
      {"max_turn_rad_per_s", &Subject::max_turn, {0.0, 100.0, "rad/s"}, "of the wrist"},
      {"max_force_N", &Subject::max_force, {0.0, 1000.0, "N"}, "the arm yields rather than push harder"},
  };
  auto subject = object<Subject>();
  for (const Field& field : kFields) {
    const auto member = field.member;
    subject->optional(
        field.name, [member](Subject& s) -> double& { return s.*member; }, number(field.range),
        std::string(field.doc) + " (ours)");
  }
  return subject;
}

std::shared_ptr<ObjectCodec<TrackingHandFields>> tracking_codec() {
  auto tracking = object<TrackingHandFields>();
  tracking->required(
      "task", [](auto& h) -> TargetRules& { return h.task; }, CodecPtr<TargetRules>(task_codec()),
      "targets and rules of a trial");
  tracking->optional(
      "subjects", [](auto& h) -> auto& { return h.subjects; }, list_of(CodecPtr<Subject>(subject_codec()), 1, 1000),
      "simulated subjects");
  tracking->optional(
      "trials", [](auto& h) -> std::int64_t& { return h.trials; }, integer(1, 1000),
      "of each subject, each from the initial state with a seed of its own");
  return tracking;
}

}  // namespace

CodecPtr<HandFields> hand_codec() {
  auto hand = tagged<HandFields>("hand");
  hand->alternative("none", object<NoHandFields>())
      .alternative("force", force_codec())
      .alternative("impedance", impedance_codec())
      .alternative("tracking", tracking_codec());
  return hand;
}

}  // namespace hapbench
