#include "scenarios/studies/stability/judged_run.hpp"

#include <algorithm>
#include <array>

#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/classify.hpp"

namespace hapbench {
namespace {

bool changes(const Profile& profile) {
  return !profile.is_constant();
}

bool any_changes(const std::array<Profile, 3>& profiles) {
  return std::any_of(profiles.begin(), profiles.end(), changes);
}

struct HandMoves {
  bool operator()(const NoHandFields&) const { return false; }
  bool operator()(const ForceHandFields& hand) const { return any_changes(hand.force); }
  bool operator()(const PushHandFields& hand) const { return changes(hand.force); }
  bool operator()(const ImpedanceHandFields& hand) const { return any_changes(hand.target); }
  bool operator()(const MassSpringDamperHandFields& hand) const { return any_changes(hand.spring.target); }
  template <class Other>
  bool operator()(const Other&) const {
    return true;
  }
};

/// Whether the tool ever touched, and where it was last.
class LastPlace final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    touches = record.colliding > 0;
    touched = touched || touches;
    position = record.tool.pose.position;
  }
  bool touched = false, touches = false;
  Vec3 position = Vec3::Zero();
};

bool has_left(const LastPlace& last, const PointShell& shell, double reach) {
  const Box bounds = shell.bounds();
  const bool inside =
      ((last.position - bounds.min).array() >= -reach).all() && ((last.position - bounds.max).array() <= reach).all();
  return !last.touches && !inside;
}

MotionClassifier classifier_of(const Scenario& scenario) {
  const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
  return is_moved(scenario) ? MotionClassifier::of_moved_tool(steps, scenario.time.step) : MotionClassifier(steps);
}

RunVerdict verdict_of(MotionClass motion) {
  // Of the same names.
  return static_cast<RunVerdict>(motion);
}
static_assert(static_cast<int>(RunVerdict::diverged) == static_cast<int>(MotionClass::diverged));

}  // namespace

std::string_view run_verdict_name(RunVerdict verdict) noexcept {
  if (verdict == RunVerdict::thrown_out) return "thrown_out";
  if (verdict == RunVerdict::no_contact) return "no_contact";
  return motion_class_name(static_cast<MotionClass>(verdict));
}

bool is_moved(const Scenario& scenario) {
  const auto& orientation = scenario.motion.orientation;
  if (!orientation || changes(orientation->tilt) || changes(orientation->azimuth)) return true;
  return std::visit(HandMoves{}, scenario.hand);
}

RunVerdict judged_run(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell) {
  const Scenario& scenario = loaded.scenario;
  MotionClassifier classifier = classifier_of(scenario);
  LastPlace last;
  SimulationParts parts = assemble(scenario, loaded.files, shell, {});
  const double reach = parts.tool->reach();
  Simulation simulation(simulation_config(scenario), std::move(parts), {&classifier, &last});
  const MotionClass motion = classify(simulation, classifier);
  if (motion == MotionClass::diverged) return RunVerdict::diverged;
  if (!last.touched) return RunVerdict::no_contact;
  if (simulation.result().outcome == Outcome::leaves_hole) return RunVerdict::thrown_out;
  if (shell && has_left(last, *shell, reach)) return RunVerdict::thrown_out;
  return verdict_of(motion);
}

bool unstable_without_contact(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  if (spring_of(scenario.hand) == nullptr || std::holds_alternative<SpringsEnvironment>(scenario.environment))
    return false;
  MotionClassifier classifier = classifier_of(scenario);
  const auto nothing = std::make_shared<const PointShell>(std::vector<SurfacePoint>{}, 0.0);
  Simulation simulation(simulation_config(scenario), assemble(scenario, loaded.files, nothing, {}), {&classifier});
  return !comes_to_rest(classify(simulation, classifier));
}

}  // namespace hapbench
