#include <fmt/format.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/extends.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

constexpr auto kMostStepsOrRows = static_cast<std::int64_t>(kMostSteps);

constexpr Choice<StopCondition> kStopConditions[] = {{"leaves_hole", StopCondition::leaves_hole},
                                                     {"tool_horizontal", StopCondition::tool_horizontal}};

/// Returns the number of steps, which may be more than a scenario can hold.
double describe_time(Fields& f, TimeFields& time) {
  std::optional<double> duration;
  f.number("step_s", time.step, {0.0, 1.0, "s", true}, "time step", Presence::required);
  f.integer("steps", time.steps, {1, kMostStepsOrRows}, "number of steps (rows)", Presence::no_default);
  f.if_any("duration_s", duration, "instead of steps: duration_s / step_s, rounded", [](Fields& d, double& value) {
    d.number(value, {0.0, 1e9, "s", true});
  });
  f.list("stop_when", time.stop_when, {0, 2}, "end early: tip centre above height 0; axis in the horizontal plane",
         [](Fields& s, StopCondition& value) { s.choice(value, kStopConditions, "stop condition"); });
  f.exactly_one_of("steps", "duration_s");
  return duration ? std::round(*duration / time.step) : static_cast<double>(time.steps);
}

/// One outcome, or a list of them.
void describe_outcomes(Fields& f, std::vector<Outcome>& outcomes) {
  std::vector<Choice<Outcome>> choices;
  for (const OutcomeInfo& known : outcome_infos()) choices.push_back({known.name, *outcome_named(known.name)});
  const auto outcome = [&choices](Fields& o, Outcome& value) { o.choice(value, choices, "outcome"); };
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

/// What the algorithm's definition overrides gives way, with a warning.
void fix_stages(Fields& f, Scenario& scenario) {
  RenderingConfig& given = scenario.rendering;
  const RenderingConfig fixed = with_fixed_stages(given);
  const bool has_depth_model = !std::holds_alternative<SpringsEnvironment>(scenario.environment);
  if (has_depth_model && given.depth_model != fixed.depth_model) {
    f.warn(fmt::format("/rendering/depth_model: \"{}\" is not used: algorithm \"{}\" is defined with \"{}\"",
                       given.depth_model, given.algorithm, fixed.depth_model));
  }
  if (given.contact_source != kOwnContacts) {
    const AlgorithmEntry& entry = *find_algorithm(given.algorithm);
    if (!entry.reported_depth_model.empty()) {
      f.warn(fmt::format("/rendering/contact_source: not used: algorithm \"{}\" finds its points itself",
                         given.algorithm));
    } else if (!entry.fixed_depth_model.empty()) {
      f.warn(
          fmt::format("/rendering/contact_source: algorithm \"{}\" is defined with depth model \"{}\"; here it has "
                      "the depths of \"{}\"",
                      given.algorithm, entry.fixed_depth_model, given.contact_source));
    }
  }
  if (given.reduction && !fixed.reduction) {
    f.warn(fmt::format("/rendering/reduction: not used: algorithm \"{}\" is defined without", given.algorithm));
  }
  given = fixed;
}

void warn_of_idle_integrator(Fields& f, const Scenario& scenario) {
  if (!handle_moves_tool(scenario.device) || scenario.integrator.type == IntegratorFields{}.type) return;
  f.warn(
      fmt::format("/integrator/type: \"{}\" is not used: device \"impedance\" moves the tool, without a virtual mass",
                  scenario.integrator.type->info.name));
}

}  // namespace

static void describe(Fields& f, InitialFields& initial) {
  f.vector3("position_m", initial.position, {-1000.0, 1000.0, "m"},
            "tip centre at t = 0; ignored when the motion prescribes it");
  f.vector3("velocity_m_per_s", initial.velocity, {-1e6, 1e6, "m/s"}, "velocity at t = 0");
}

static void describe(Fields& f, IntegratorFields& integrator) {
  std::vector<Choice<const IntegratorEntry*>> choices;
  for (const IntegratorEntry* entry : kIntegrators) choices.push_back({entry->info.name, entry});
  f.choice("type", integrator.type, choices, "integrator",
           "leapfrog is the thesis's; \"hapbench describe NAME\" explains each", Presence::required);
}

static void describe(Fields& f, DivergenceBounds& bounds) {
  f.number("position_m", bounds.position, {0.0, 1e9, "m", true},
           "a run whose tip centre is further from the origin has diverged");
  f.number("speed_m_per_s", bounds.speed, {0.0, 1e12, "m/s", true}, "a run whose tool is faster has diverged");
  f.number("force_N", bounds.force, {0.0, 1e15, "N", true}, "a run whose rendered force is larger has diverged");
}

static void describe(Fields& f, RecordFields& record) {
  f.boolean("trajectory", record.trajectory, "write trajectory.csv");
  f.integer("every", record.every, {1, kMostStepsOrRows}, "record each N-th step only");
  f.list("ratio_iterations", record.ratio_iterations, {0, 1000},
         "write ratios.csv after these numbers of shaping iterations", [](Fields& i, std::int64_t& value) {
           i.integer(value, {0, 100'000});
         });
  f.boolean("contacts", record.contacts, "write contacts.csv");
  f.boolean("stiffness_tensor", record.stiffness_tensor, "write stiffness_tensor.csv");
  f.boolean("timing", record.timing, "time every step and write timing.json");
  f.boolean("energy", record.energy, "keep the energy ledger and write energy.csv");
  f.boolean("ideal_trajectory", record.ideal_trajectory,
            "block_with_hole only: compare the recorded rows with the ideal trajectory and write ideal_trajectory.csv");
  f.boolean("force_reference", record.force_reference,
            "with reference_force, or a stroke with a measured force: write it and the error into force_reference.csv");
  f.boolean("pose", record.pose, "add the tool's orientation to trajectory.csv, as a quaternion qw,qx,qy,qz");
  f.boolean("torque", record.torque,
            "add the torque that is lost to trajectory.csv, tx_Nm,ty_Nm,tz_Nm, and its metrics: what the rendered "
            "contacts would exert about the tip centre and the device cannot render");
}

static void describe(Fields& f, SettlingRule& metrics) {
  f.number("from_s", metrics.from, {0.0, 1e9, "s"},
           "rows in contact from here on are settled, all before are landing; null: a landing is what follows a first "
           "touch");
  f.number("settling_s", metrics.time, {0.0, 1e9, "s"},
           "how long a landing lasts, and how long the tool must be away for the next touch to be a first one");
}

static void describe(Fields& f, PerceptionThresholds& thresholds) {
  f.number("force_jnd", thresholds.force_jnd, {0.0, 10.0, "1"},
           "smallest change of a force that is noticed, of the force (Jones 1989; Pang, Tan and Durlach 1991)");
  f.number("least_force_N", thresholds.least_force, {0.0, 1e6, "N"},
           "below this force the noticeable change is that of this force");
  f.group("band_Hz", "the band in which touch is most sensitive (Bolanowski et al. 1988)", [&](Fields& band) {
    band.number("from", thresholds.band_from, {0.0, 1e6, "Hz", true}, "its low end");
    band.number("to", thresholds.band_to, {0.0, 1e6, "Hz", true}, "its high end");
  });
  f.number("amplitude_at_250Hz_m", thresholds.amplitude_at_250Hz, {0.0, 1.0, "m", true},
           "of a vibration that is just felt (the same)");
}

static void describe(Fields& f, MetricBound& bound) {
  const auto number = [](Fields& b, double& value) { b.number(value, {-1e15, 1e15}); };
  f.if_any("min", bound.min, "smallest value allowed", number);
  f.if_any("max", bound.max, "largest value allowed", number);
  if (!f.reads() || !bound.min || !bound.max || !(*bound.min > *bound.max)) return;
  throw InputError(InputError::Kind::relation, f.at(),
                   fmt::format("got min {} above max {}; allowed: min <= max", *bound.min, *bound.max));
}

static void describe(Fields& f, ReferenceForceFields& reference) {
  constexpr const char* kNames[] = {"x_N", "y_N", "z_N"};
  for (std::size_t i = 0; i < 3; ++i) profile(f, kNames[i], reference.force[i], "N", "force on the tool over time");
}

static void describe(Fields& f, ExpectFields& expect) {
  static const MetricList kMetrics = metrics_without_values();
  f.field("outcome", "how the run must end, or a list of ways", Presence::has_default,
          [&expect](Fields& value) { describe_outcomes(value, expect.outcomes); });
  f.group("metrics", "bounds on the run's metrics, min and max of each; \"hapbench list metrics\" shows them",
          [&expect](Fields& metrics) {
            for (const auto& [name, unit, meaning, value] : kMetrics) {
              const auto known = expect.metrics.find(name);
              std::optional<MetricBound> bound;
              if (known != expect.metrics.end()) bound = known->second;
              metrics.if_any(name, bound, meaning, [](Fields& b, MetricBound& limits) { b.object(limits); });
              if (bound) expect.metrics[name] = *bound;
            }
          });
}

/// Reading a file has replaced the field by what it names.
static void describe_extends(Fields& f) {
  std::string other;
  f.text(kExtends, other, 4096,
         "another scenario, a file or a bundled name, over whose fields (but name and expect) these are merged; "
         "null replaces; so does an object of another type",
         Presence::left_out);
  if (!f.reads() || !f.given(kExtends)) return;
  throw InputError(InputError::Kind::relation, member(f.at(), kExtends), "got it in no file; allowed: in files");
}

void describe(Fields& f, Scenario& scenario) {
  double steps = 0.0;
  f.ignored("$schema", "the JSON Schema, for editors");
  describe_extends(f);
  f.text("name", scenario.name, 200, "default: the file's name");
  f.text("description", scenario.description, 10'000, "what it shows");
  f.text("source", scenario.source, 1000, "where the numbers come from");
  f.integer("seed", scenario.seed, {0, std::int64_t{1} << 53}, "of everything random");
  f.group(
      "time", "time steps", [&](Fields& time) { steps = describe_time(time, scenario.time); }, Presence::required);
  f.value("environment", scenario.environment, "what the tool touches", Presence::required);
  if (f.reads()) set_scene_defaults(scenario);
  f.object("initial", scenario.initial, "state at t = 0");
  f.value("tool", scenario.tool, "the tool; without a type it is a cylinder");
  f.object("motion", scenario.motion, "scripted motion");
  f.value("hand", scenario.hand, "who holds the handle");
  f.value("device", scenario.device, "the haptic device");
  f.object("rendering", scenario.rendering, "how contacts become a force");
  f.object("integrator", scenario.integrator, "how forces become motion");
  f.object("bounds", scenario.bounds, "where a run counts as diverged");
  f.if_any("reference_force", scenario.reference_force,
           "the force an ideal rendering would give on a prescribed way; the metrics of fidelity are taken against it",
           [](Fields& o, ReferenceForceFields& reference) { o.object(reference); });
  f.object("record", scenario.record, "what is written beside the summary");
  f.object("metrics", scenario.metrics, "where metrics of settled contact begin");
  f.if_any("perception", scenario.perception, "from when on people feel something; adds the metrics of perception",
           [](Fields& o, PerceptionThresholds& thresholds) { o.object(thresholds); });
  f.object("expect", scenario.expect, "what the run must show; each scenario is its own regression test");
  if (!f.reads()) return;
  check_relations(scenario, steps);
  scenario.time.steps = static_cast<std::int64_t>(steps);
  fix_stages(f, scenario);
  warn_of_idle_integrator(f, scenario);
}

}  // namespace hapbench
