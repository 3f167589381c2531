#include "scenarios/scene/describe_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/describe_rendering.hpp"
#include "scenarios/scene/devices.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/hands.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/motions.hpp"
#include "scenarios/scene/profiles.hpp"
#include "scenarios/scene/scenario_rules.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

constexpr auto kMaxStepsOrRows = static_cast<std::int64_t>(kMaxSteps);

/// Describes the field `time`. Returns the number of time steps, which may exceed the allowed number and the
/// range of integers.
double describe_time(Fields& f, TimeFields& time) {
  std::optional<double> duration;
  f.number("step_s", time.step, {0.0, 1.0, "s", true}, "time step", Presence::required);
  f.integer("steps", time.steps, {1, kMaxStepsOrRows},
            "number of time steps, which is the number of rows of trajectory.csv if every step is recorded",
            Presence::no_default);
  f.if_any("duration_s", duration,
           "duration of the run, in place of steps; the number of steps is duration_s / step_s, rounded",
           [](Fields& d, double& value) {
             d.number(value, {0.0, 1e9, "s", true});
           });
  f.list(
      "stop_when", time.stop_when, {0, 2},
      "conditions that end the run early: leaves_hole (tip centre above height 0), tool_horizontal (tool axis in the "
      "horizontal plane)",
      [](Fields& s, StopCondition& value) {
        s.choice(value, {"leaves_hole", "tool_horizontal"}, "stop condition");
      });
  f.exactly_one_of("steps", "duration_s");
  return duration ? std::round(*duration / time.step) : static_cast<double>(time.steps);
}

/// Describes a field with one outcome or a list of outcomes.
void describe_outcomes(Fields& f, std::vector<Outcome>& outcomes) {
  const std::vector<std::string> names = names_of(outcome_infos(), &OutcomeInfo::name);
  const auto outcome = [&names](Fields& o, Outcome& value) { o.choice(value, names, "outcome"); };
  f.one_or_list(
      outcomes.size() != 1,
      [&](Fields& one) {
        Outcome value = outcomes.empty() ? Outcome::completes : outcomes.front();
        outcome(one, value);
        if (one.reads()) outcomes = {value};
      },
      [&](Fields& several) {
        several.list(outcomes, {1, outcome_infos().size()}, outcome);
      });
}

/// Sets the fields whose defaults depend on the type of the environment to the thesis's parameters (Tables A.1, A.2,
/// B.1). Does nothing for springs, whose parameters are the structs' default values.
void set_scene_defaults(Scenario& scenario) {
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return;
  RenderingConfig& rendering = scenario.rendering;
  rendering.mu_s = 5.0;
  rendering.mu_f = 10.0;
  if (std::holds_alternative<Hole2d>(scenario.environment)) {
    scenario.tool = CylinderFields{.length = 0.005, .tip = Tip::round};
  } else {
    scenario.motion.orientation->up = {0.0, 0.0, 1.0};
    rendering.mass = 0.1;
  }
}

}  // namespace

static void describe(Fields& f, InitialFields& initial) {
  f.vector3("position_m", initial.position, {-1000.0, 1000.0, "m"},
            "position of the tip centre at t = 0; ignored if motion prescribes the position");
  f.vector3("velocity_m_per_s", initial.velocity, {-1e6, 1e6, "m/s"},
            "velocity of the tip centre at t = 0; ignored if motion prescribes the position");
}

static void describe(Fields& f, IntegratorFields& integrator) {
  std::string type = integrator.type->info.name;
  const auto names = names_of(kIntegrators, [](const IntegratorEntry* entry) { return entry->info.name; });
  f.choice("type", type, names, "integrator",
           "integration method; the thesis uses leapfrog; \"hapbench describe NAME\" explains each",
           Presence::required);
  if (f.reads()) integrator.type = *std::ranges::find(kIntegrators, type, [](auto* entry) { return entry->info.name; });
  f.number("tolerance_s", integrator.tolerance, {1e-15, 1.0, "s"},
           "with integrator event: accuracy of the times at which contacts begin and end; default 1e-9",
           integrator.type == &kEvent ? Presence::no_default : Presence::omitted);
}

static void describe(Fields& f, DivergenceBounds& bounds) {
  f.number("position_m", bounds.position, {0.0, 1e9, "m", true},
           "largest distance of the tip centre from the origin; a run beyond it has diverged");
  f.number("speed_m_per_s", bounds.speed, {0.0, 1e12, "m/s", true},
           "largest speed of the tool; a run beyond it has diverged");
  f.number("force_N", bounds.force, {0.0, 1e15, "N", true},
           "largest norm of the rendered force; a run beyond it has diverged");
}

static void describe(Fields& f, RecordFields& record) {
  f.boolean("trajectory", record.trajectory, "write trajectory.csv");
  f.integer("every", record.every, {1, kMaxStepsOrRows}, "record only every n-th time step");
  f.list("ratio_iterations", record.ratio_iterations, {0, 1000},
         "numbers of shaping iterations after which stiffness ratios are written to ratios.csv",
         [](Fields& i, std::int64_t& value) {
           i.integer(value, {0, 100'000});
         });
  f.boolean("contacts", record.contacts, "write contacts.csv and contact_trace.csv");
  f.boolean("stiffness_tensor", record.stiffness_tensor, "write stiffness_tensor.csv");
  f.boolean("timing", record.timing, "measure the wall time of every step and write timing.json");
  f.boolean("energy", record.energy, "compute the energy balance and write energy.csv");
  f.boolean(
      "ideal_trajectory", record.ideal_trajectory,
      "block_with_hole only: compare the recorded steps with the ideal trajectory and write ideal_trajectory.csv");
  f.boolean("force_reference", record.force_reference,
            "with reference_force, or a stroke with a measured force: write the reference force and the force error to "
            "force_reference.csv");
  // The field is written only if it is true, so that it appears only in scenarios that use it.
  f.field("six_dof", "with six_dof: write the forces and torques of both devices to six_dof.csv; default: false",
          record.six_dof ? Presence::no_default : Presence::omitted,
          [&record](Fields& value) { value.boolean(record.six_dof); });
  for (const TrajectoryGroup& group : trajectory_groups())
    f.boolean(group.field, record.*group.is_wanted, group.effect);
}

static void describe(Fields& f, SettlingRule& metrics) {
  f.number(
      "from_s", metrics.from, {0.0, 1e9, "s"},
      "time from which all steps in contact count as settled; all steps before this time count as landing; null: a "
      "landing begins at the first touch of the run, and at each touch after at least settling_s without contact");
  f.number("settling_s", metrics.time, {0.0, 1e9, "s"},
           "duration of a landing; also the time without contact after which the next touch begins a landing");
}

static void describe(Fields& f, MetricBound& bound) {
  const auto number = [](Fields& b, double& value) { b.number(value, {-1e15, 1e15}); };
  f.if_any("min", bound.min, "smallest allowed value", number);
  f.if_any("max", bound.max, "largest allowed value", number);
  if (!f.reads() || !bound.min || !bound.max || !(*bound.min > *bound.max)) return;
  fail_at(f.at(), fmt::format("got min {} above max {}; allowed: min <= max", *bound.min, *bound.max));
}

static void describe(Fields& f, GivenForceFields& reference) {
  profiles(f, {"x_N", "y_N", "z_N"}, reference.force, "N",
           "component of the reference force on the tool, as a function of time");
}

static void describe(Fields& f, SixDofFields& fields) {
  std::vector<std::string> laws = algorithm_names();
  laws.emplace_back(kMatchedProxy);
  const auto law = [&laws](Fields& l, std::string& name) {
    if (name.empty()) name = laws.front();
    l.choice(name, laws, "law");
  };
  std::optional<std::string> chosen;
  if (!fields.law.empty()) chosen = fields.law;
  f.if_any(
      "law", chosen,
      "law that the 3-DOF device renders: the name of an algorithm, or matched_proxy, the proxy with the rotational "
      "stiffness K_r K_phi / (K_r + K_phi); default: rendering.algorithm",
      law);
  if (f.reads() && chosen) fields.law = *chosen;
  constexpr NumberRange kTurning = {0.0, 1e12, "N m/rad", true};
  constexpr NumberRange kAlongAxis = {-1.0, 1.0, "m"};
  f.number("hand_stiffness_N_per_m", fields.hand, {0.0, 1e12, "N/m", true}, "K_h, stiffness of the hand at the grip");
  f.number("hand_rotational_stiffness_N_m_per_rad", fields.hand_rotation, kTurning,
           "K_phi, rotational stiffness of the hand about the grip");
  f.number(
      "coupling_rotational_stiffness_N_m_per_rad", fields.coupling_rotation, kTurning,
      "K_r, rotational stiffness of the coupling of the 6-DOF device; the translational stiffness of this coupling is "
      "rendering.stiffness_N_per_m");
  f.number("force_point_m", fields.force_point, {0.0, 1.0, "m"},
           "distance from the tip centre back along the axis to the point at which the devices apply the force");
  f.number("grip_m", fields.grip, kAlongAxis,
           "distance from the force point to the grip, the point about which the hand lets the handle rotate; positive "
           "towards the tip");
  f.number(
      "pivot_m", fields.pivot, kAlongAxis,
      "distance from the tip centre back along the axis to the point about which the intended motion rotates the tool; "
      "the scripted motion of the tip is added to this rotation");
}

static void describe(Fields& f, ExpectFields& expect) {
  f.field("outcome", "expected outcome of the run, or a list of allowed outcomes", Presence::has_default,
          [&expect](Fields& value) { describe_outcomes(value, expect.outcomes); });
  f.group("metrics", "bounds on metrics of the run, with min and max; \"hapbench describe metrics\" lists the metrics",
          Presence::has_default, [&expect](Fields& metrics) {
            for (const Metric& metric : all_metrics()) {
              const auto known = expect.metrics.find(metric.name);
              std::optional<MetricBound> bound;
              if (known != expect.metrics.end()) bound = known->second;
              metrics.if_any(metric.name, bound, metric.meaning, [](Fields& b, MetricBound& limits) {
                b.shared("metric_bound", [&limits](Fields& s) { s.object(limits); });
              });
              if (bound) expect.metrics[metric.name] = *bound;
            }
          });
}

/// Describes the field `extends`. For a file, read_scenario_text() merges the scenario that this field names into the
/// JSON and removes the field. If the field is still present, the JSON does not come from a file, and InputError is
/// thrown.
static void describe_extends(Fields& f) {
  std::string other;
  f.text(kExtends, other, 4096,
         "base scenario, as a file or a bundled name: the fields of this file are merged over its fields (except name "
         "and expect). null and an object of another type replace the base's field",
         Presence::omitted);
  if (!f.reads() || !f.given(kExtends)) return;
  fail_at(member(f.at(), kExtends), "got a base scenario outside of a file; allowed: only in a scenario file");
}

void describe(Fields& f, Scenario& scenario) {
  // Name, origin and seed.
  double steps = 0.0;
  f.ignored("$schema", "JSON Schema of this file, for editors");
  describe_extends(f);
  f.text("name", scenario.name, 200, "name of the scenario; default: the file's name");
  f.text("description", scenario.description, 10'000, "what the scenario shows");
  f.text("source", scenario.source, 1000, "source of the scenario's numbers");
  f.integer("seed", scenario.seed, {0, std::int64_t{1} << 53}, "seed of all random numbers");
  // Time and environment. The environment's type determines defaults of the fields that follow.
  f.group("time", "time step and number of steps", Presence::required,
          [&](Fields& time) { steps = describe_time(time, scenario.time); });
  f.value("environment", scenario.environment, "environment: the object that the tool touches", Presence::required);
  if (f.reads()) set_scene_defaults(scenario);
  // Tool, hand, device and rendering.
  f.object("initial", scenario.initial, "state of the tool at t = 0");
  f.value("tool", scenario.tool, "tool; without a type it is a cylinder");
  f.object("motion", scenario.motion, "scripted motion of the tool");
  f.value("hand", scenario.hand, "model of the hand that holds the handle");
  f.value("device", scenario.device, "model of the haptic device");
  f.object("rendering", scenario.rendering, "how forces are computed from contacts");
  f.object("integrator", scenario.integrator, "how the motion is computed from forces");
  // Limits, output and expectations.
  f.object("bounds", scenario.bounds, "bounds beyond which a run counts as diverged");
  f.if_any(
      "reference_force", scenario.reference_force,
      "force that an ideal rendering would give on the prescribed motion, or in the same hand. The metrics of group "
      "fidelity compare the rendered force with this reference force. Without a type, the reference force is given as "
      "functions of time",
      [](Fields& value, ReferenceForceFields& reference) {
        value.variant(
            reference, "reference force",
            {{"given", "force as a function of time"},
             {"rigid_contact",
              "K (x' - x): force of frictionless contact with the rigid triangles of the mesh. x is the prescribed "
              "position of the tool, x' the nearest position in which the tool does not penetrate the mesh, and K is "
              "rendering.stiffness_N_per_m. If a hand of type impedance or mass_spring_damper moves the tool, x is the "
              "hand's target and K the hand's stiffness. The force is then static, without inertia and damping"}},
            Untyped::first);
      });
  f.object_if_any(
      "six_dof", scenario.six_dof,
      "comparison of the law on a 3-DOF device with a 6-DOF device. Both devices are quasi-static and held by the hand "
      "that this object describes. The scripted motion is the motion that the hand intends. Adds the metrics of group "
      "six_dof");
  f.object("record", scenario.record, "what is written in addition to summary.json");
  f.object("metrics", scenario.metrics, "which steps count as landing and which as settled contact");
  f.object("expect", scenario.expect,
           "requirements on the result of the run; an unmet requirement gives exit status 3");
  if (!f.reads()) return;
  // Check the rules between fields and derive values.
  resolve_delay(scenario);
  check_relations(scenario, steps);
  scenario.time.steps = static_cast<std::int64_t>(steps);
  scenario.rendering = with_fixed_stages(scenario.rendering);
}

}  // namespace hapbench
