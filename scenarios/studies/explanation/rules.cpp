#include "scenarios/studies/explanation/rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/stages/damping_and_limits.hpp"
#include "device_model/velocity_filter.hpp"
#include "results/observe/butterworth.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "scenarios/studies/convergence/level_sweep.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "scenarios/studies/stability/scene_loop.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

Json read_json(const fs::path& file) {
  try {
    return parse_json(read_text_file(file, kLargestJsonFile));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

void collect(const Json& json, const std::string& name, RunFiles& run) {
  if (json.is_number()) run.metrics[name] = json.get<double>();
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) collect(value, name.empty() ? key : name + "." + key, run);
}

std::vector<ReadRow> read_rows(const fs::path& file) {
  const std::string text = read_text_file(file, kLargestTable);
  CsvReader csv(LineReader(text), file);
  constexpr std::array kNames = {"time_s",  "px_m",      "py_m",      "pz_m",      "fx_N",     "fy_N",
                                 "fz_N",    "fmeas_x_N", "fmeas_y_N", "fmeas_z_N", "fin_x_N",  "fin_y_N",
                                 "fin_z_N", "hx_m",      "hy_m",      "hz_m",      "colliding"};
  std::array<std::size_t, kNames.size()> places{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::ranges::find(csv.columns(), std::string_view(kNames[i]));
    if (found == csv.columns().end()) throw InputError(fmt::format("{}: has no column {}", file.string(), kNames[i]));
    places[i] = static_cast<std::size_t>(found - csv.columns().begin());
  }
  std::vector<ReadRow> rows;
  while (csv.next_not_blank()) {
    std::array<double, kNames.size()> n{};
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = finite_number(csv.cells()[places[i]]).value_or(0.0);
    rows.push_back({n[0],
                    {n[1], n[2], n[3]},
                    {n[4], n[5], n[6]},
                    {n[7], n[8], n[9]},
                    {n[10], n[11], n[12]},
                    {n[13], n[14], n[15]},
                    n[16] > 0.0});
  }
  return rows;
}

}  // namespace

std::optional<double> RunFiles::metric(std::string_view name) const {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(found->second);
}

RunFiles read_run(const fs::path& folder) {
  RunFiles run;
  run.loaded = load_scenario(folder / "scenario.effective.json");
  const fs::path file = folder / "summary.json";
  const Json summary = read_json(file);
  if (!summary.is_object() || !summary.contains("outcome") || !summary.contains("metrics"))
    throw InputError(file.string() + ": is not what a run writes");
  run.outcome = summary["outcome"].get<std::string>();
  collect(summary["metrics"], "", run);
  for (const char* section : {"passivity", "steps", "duration_s"})
    if (summary.contains(section)) collect(summary[section], section, run);
  if (const Json left = summary.value("divergence", Json()); left.is_object())
    run.ending = fmt::format("{} in step {}", left.value("quantity", ""), left.value("step", 0));
  else if (const Json warnings = summary.value("warnings", Json()); run.outcome != "completes" && !warnings.empty())
    run.ending = warnings[0].is_string() ? warnings[0].get<std::string>() : "";
  if (fs::exists(folder / "trajectory.csv")) run.rows = read_rows(folder / "trajectory.csv");
  if (fs::exists(folder / "timing.json")) {
    const Json timing = read_json(folder / "timing.json");
    for (const char* name : {"/step_latency/p99_s", "/step_p99_s"}) {
      const Json::json_pointer at(name);
      if (!run.step_time && timing.contains(at) && timing[at].is_number()) run.step_time = timing[at].get<double>();
    }
  }
  return run;
}

namespace {

using RuleNumber = std::optional<double>;

// ---- Numbers of the run

RuleNumber quotient(const RuleNumber& a, const RuleNumber& b) {
  return a && b && *b > 0.0 ? RuleNumber(*a / *b) : std::nullopt;
}

RuleNumber if_outcome(const RunFiles& run, std::initializer_list<const char*> names) {
  const bool is = std::ranges::any_of(names, [&](const char* name) { return run.outcome == name; });
  return is ? RuleNumber(1.0) : std::nullopt;
}

std::string ending(const RunFiles& run) {
  return run.ending;
}

/// Springs that come to rest have no force that a step of it could be compared with.
bool completed(const RunFiles& run) {
  if (std::holds_alternative<SpringsEnvironment>(run.scenario().environment) &&
      !(run.metric("vibration_last_quarter_m_per_s").value_or(0.0) > kMostVibration))
    return false;
  return run.outcome != "diverges" && run.outcome != "went_through" && run.outcome != "no_contact";
}

/// The share of rows in contact of which `is` holds.
template <class Is>
RuleNumber share_in_contact(const RunFiles& run, Is is) {
  std::size_t touching = 0, found = 0;
  for (const ReadRow& row : run.rows) {
    touching += row.touches;
    found += row.touches && is(row);
  }
  return touching > 0 ? RuleNumber(static_cast<double>(found) / static_cast<double>(touching)) : std::nullopt;
}

/// Metrics of settled contact do not exist in short ones; those of a run that ends otherwise mean something else.
RuleNumber vibration_share(const RunFiles& run) {
  if (!completed(run)) return std::nullopt;
  return quotient(run.metric("force_rms_above_30Hz_N"), run.metric("force_mean_in_contact_N"));
}

/// Half the sign changes of the strongest component of the force above 30 Hz in the last quarter, over its time [Hz].
RuleNumber buzz_frequency(const RunFiles& run) {
  const std::size_t first = run.rows.size() - run.rows.size() / 4;
  if (run.rows.size() < 40) return std::nullopt;
  const double step = run.rows[1].time - run.rows[0].time;
  auto filter = vibration_filter(step);
  if (!filter) return std::nullopt;
  filter->settle_at(run.rows[0].force);
  std::vector<Vec3> high;
  for (std::size_t i = 0; i < run.rows.size(); ++i) {
    const Vec3 f = filter->filter(run.rows[i].force);
    if (i >= first) high.push_back(f);
  }
  Vec3 power = Vec3::Zero();
  for (const Vec3& f : high) power += f.cwiseAbs2();
  Eigen::Index axis = 0;
  power.maxCoeff(&axis);
  int turns = 0;
  for (std::size_t i = 1; i < high.size(); ++i) turns += high[i][axis] * high[i - 1][axis] < 0.0;
  return 0.5 * turns / (step * static_cast<double>(high.size()));
}

/// K over the edge of the linear loop in contact, along the stiffest contact seen; none without contact or loop.
RuleNumber share_of_edge(const RunFiles& run) {
  const Scenario& scenario = run.scenario();
  const RuleNumber lambda = run.metric("ratio_max");
  const double K = scenario.rendering.stiffness;
  if (!lambda || !(*lambda > 0.0) || !(K > 0.0)) return std::nullopt;
  if (contact_step(scenario, *lambda).size() == 0) return std::nullopt;
  Scenario at = scenario;
  const auto step_at = [&](double stiffness) {
    at.rendering.stiffness = stiffness;
    return contact_step(at, *lambda);
  };
  return K / std::max(1e-12 * K, first_edge(1e-4 * K, 1e4 * K, step_at));
}

/// True where the run vibrates as at an edge, or left its bounds.
bool shakes(const RunFiles& run) {
  return run.outcome == "diverges" || vibration_share(run).value_or(0.0) > 0.1 ||
         run.metric("vibration_last_quarter_m_per_s").value_or(0.0) > kMostVibration;
}

RuleNumber tool_half_width(const RunFiles& run) {
  if (std::holds_alternative<SpringsEnvironment>(run.scenario().environment)) return std::nullopt;
  return scene_facts(run.loaded).tool.half_width;
}

/// The length of the tip's way while it touches [m].
double way_in_contact(const RunFiles& run) {
  double way = 0.0;
  for (std::size_t i = 1; i < run.rows.size(); ++i) {
    if (run.rows[i].touches && run.rows[i - 1].touches) way += (run.rows[i].tip - run.rows[i - 1].tip).norm();
  }
  return way;
}

/// The distance of the points over that at which four of them are in contact.
RuleNumber coarseness(const RunFiles& run) {
  const auto distance = point_distance(run.loaded);
  const RuleNumber contacts = quotient(run.metric("colliding_mean"), run.metric("contact_share"));
  if (!distance || !contacts || !completed(run) || way_in_contact(run) < 10.0 * distance->metres) return std::nullopt;
  constexpr double kEnough = 4.0;
  return std::sqrt(kEnough / *contacts);
}

/// The largest force that a step of the encoder makes through B.
RuleNumber encoder_force(const RunFiles& run) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&run.scenario().device);
  if (device == nullptr) return std::nullopt;
  constexpr int kSamples = 100;  // in which a filter of any order has its peak, or passes next to nothing
  VelocityFilter filter(device->velocity_filter, run.scenario().time.step);
  filter.reset(Vec3::Zero());
  double fastest = 0.0;
  for (int i = 0; i < kSamples; ++i) fastest = std::max(fastest, filter.read(Vec3(device->encoder_step, 0.0, 0.0)).x());
  return quotient(normal_damping(run.scenario().rendering) * fastest, run.metric("force_mean_in_contact_N"));
}

/// B dt / m of the mass that moves, times the largest stiffness ratio: 2 is the limit of an explicit step.
RuleNumber damping_number(const RunFiles& run) {
  const Scenario& s = run.scenario();
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&s.device);
  const RuleNumber lambda = run.metric("ratio_max");
  if (!lambda) return std::nullopt;
  return *lambda * normal_damping(s.rendering) * s.time.step /
         (device != nullptr ? device->handle_mass : s.rendering.mass);
}

RuleNumber drift(const RunFiles& run) {
  const Scenario& scenario = run.scenario();
  if (run.rows.size() < 40 || !completed(run) || is_moved(scenario) ||
      !std::holds_alternative<FreePosition>(scenario.motion.position))
    return std::nullopt;
  const std::size_t n = run.rows.size();
  for (std::size_t i = n - n / 4; i < n; ++i)
    if (!run.rows[i].touches) return std::nullopt;
  const Vec3 push = run.rows[n - 1].force.normalized();
  Vec3 way = run.rows[n - 1].tip - run.rows[n - n / 4].tip;
  way -= way.dot(push) * push;
  return quotient(way.norm(), tool_half_width(run));
}

RuleNumber motor_share(const RunFiles& run) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&run.scenario().device);
  RuleNumber most = device != nullptr ? device->force_max : std::nullopt;
  if (const RuleNumber limit = run.scenario().rendering.max_force) most = std::min(most.value_or(*limit), *limit);
  if (!most) return std::nullopt;
  return share_in_contact(run, [&](const ReadRow& row) { return row.force.norm() >= 0.999 * *most; });
}

RuleNumber limiter_share(const RunFiles& run) {
  const RuleNumber most = input_force_limit(run.scenario().device);
  if (!most) return std::nullopt;
  return share_in_contact(run, [&](const ReadRow& row) { return row.driving.norm() >= 0.999 * *most; });
}

// ---- Rules

constexpr ExplainRule kRules[] = {
    {"diverged", "1 where the run left its bounds", "1", 0.5, "it diverged",
     "\"hapbench tune\" for K and zeta; a shorter time.step_s",
     [](const RunFiles& r) { return if_outcome(r, {"diverges"}); }, ending},
    {"sank", "1 where the tool went through the surface", "1", 0.5, "the tool went through the surface",
     "more K; a law that does not get softer with contacts, such as shaped_stiffness or proxy; a plate thicker than a step's way",
     [](const RunFiles& r) { return if_outcome(r, {"went_through"}); }, ending},
    {"lost", "1 where the tool touched nothing, or not in the end", "1", 0.5, "the tool is not where the surface is",
     "environment.scale, initial.position_m and the hand's direction: \"hapbench validate\" shows them",
     [](const RunFiles& r) {
       return if_outcome(r, {"no_contact", "lost_contact"});
     },
     ending},
    {"stuck", "1 where the hand went on and the tool did not", "1", 0.5, "the tool is stuck",
     "less friction, a stiffer hand, or another law: a proxy or least_squares may hold it in a corner",
     [](const RunFiles& r) {
       return if_outcome(r, {"stuck", "not_dragged"});
     },
     ending},
    {"edge", "K over the edge of the loop of device, tool and stiffest contact, without dry friction, where it shakes",
     "1", 0.8, "K is {} times the edge of the stable loop",
     "less K, less delay or filter, another zeta: \"hapbench tune\"",
     [](const RunFiles& r) { return shakes(r) ? share_of_edge(r) : std::nullopt; }},
    {"buzz", "force above 30 Hz over the mean force in settled contact", "1", 0.1,
     "it buzzes: the force above 30 Hz is {} of the mean force",
     "a velocity filter or less zeta where the encoder is coarse, less K, a law with smaller steps; \"hapbench tune --max-vibration\"",
     vibration_share,
     [](const RunFiles& r) {
       const RuleNumber f = buzz_frequency(r);
       return f ? fmt::format("at about {:.0f} Hz", *f) : std::string();
     }},
    {"pop", "largest force step in settled contact over the mean force", "1", 0.5,
     "it pops: a step of the force is {} of the mean force",
     "rendering.reduction null; corners and thin parts make laws flip: \"hapbench compare --algorithms all\" shows which least",
     [](const RunFiles& r) {
       return completed(r) ? quotient(r.metric("settled_force_step_max_N"), r.metric("force_mean_in_contact_N"))
                           : std::nullopt;
     }},
    {"reduction", "largest force step where the kept contacts change, over the mean force in settled contact", "1", 0.1,
     "the force steps by {} of its mean when the kept contacts change", "rendering.reduction null, or merged_shaping",
     [](const RunFiles& r) {
       return quotient(r.metric("reduction_force_step_max_N"), r.metric("force_mean_in_contact_N"));
     }},
    {"facets", "distance of the surface's points over that at which four are in contact, where the tool moves on them",
     "1", 1.15, "the surface is sampled too coarsely, facets are felt: {} times the distance that keeps four contacts",
     "half of environment.spacing_m or grid_m; \"compare --errors\" tells what depends on it", coarseness,
     [](const RunFiles& r) {
       const auto distance = point_distance(r.loaded);
       return distance ? fmt::format("now {}", length_text(distance->metres)) : std::string();
     }},
    {"deep", "depth inside in settled contact over the tool's half width", "1", 0.75,
     "the tool sinks in by {} of its half width",
     "more K; \"hapbench tune --max-inside\" tells whether the device allows it",
     [](const RunFiles& r) {
       return completed(r) ? quotient(r.metric("inside_settled_m"), tool_half_width(r)) : std::nullopt;
     }},
    {"soft", "K over the stiffness along the softest contact", "1", 3.0,
     "along some contact it is {} times as soft as K says",
     "mean and DP get softer with contacts: shaped_stiffness does not",
     [](const RunFiles& r) { return quotient(1.0, r.metric("ratio_min")); }},
    {"hard", "stiffness along the stiffest contact over K", "1", 3.0, "contacts add up to {} K",
     "summation gets stiffer with contacts: shaped_stiffness, or K divided by it",
     [](const RunFiles& r) { return r.metric("ratio_max"); }},
    {"damping", "B dt / m of the mass that moves, along the stiffest contact; 2 is the most a step bears", "1", 1.0,
     "the damping of a step is {} of the mass",
     "less zeta, a shorter time.step_s, rendering.limits.max_damping_N_s_per_m", damping_number},
    {"friction", "rows beyond the force whose friction an explicit step bears", "1", 0.0,
     "explicit friction is unstable in {} rows: what follows is the integrator's doing",
     "smaller rendering.friction.mu_f_s_per_m, {\"type\": \"dry\"}, or a shorter step",
     [](const RunFiles& r) { return r.metric("explicit_friction_rows_beyond"); }},
    {"encoder", "force of one step of the encoder through B over the mean force", "1", 0.1,
     "each step of the encoder is a force of {} of the mean through the damping",
     "less zeta, device.velocity_filter low_pass, a finer encoder", encoder_force},
    {"saturated", "share of the rows in contact at the largest force", "1", 0.01,
     "the force is saturated in {} of the contact", "less K or a gentler hand; a stronger device", motor_share},
    {"limiter", "share of the rows in contact with more hand force than the device's limiter lets in", "1", 0.2,
     "the limiter of the hand's force cuts in {} of the contact", "a gentler hand; device.force_limit_N is f_th of 2.7",
     limiter_share},
    {"bounces", "landings a second", "1/s", 8.0, "it bounces: {} landings a second",
     "more zeta, less K or a heavier tool",
     [](const RunFiles& r) { return quotient(r.metric("landings"), r.metric("duration_s")); }},
    {"chatter", "turns of the force by more than 90 degrees a second in settled contact", "1/s", 10.0,
     "it chatters: the force turns round {} times a second",
     "contacts on opposite sides fight: shaped_stiffness or proxy; less K in a narrow hole",
     [](const RunFiles& r) { return completed(r) ? r.metric("force_reversals_per_s") : std::nullopt; }},
    {"energy", "energy that the rendering created", "J", 1e-3, "the rendering created {} J",
     "rendering.passivity_controller, another law, less K on a device",
     [](const RunFiles& r) { return completed(r) ? r.metric("passivity.net_created_J") : std::nullopt; }},
    {"drift", "way across the force of a tool that a constant hand holds, in the last quarter, over its half width",
     "1", 0.05, "it drifts by {} of its half width under a constant hand",
     "viscous friction never holds: rendering.friction {\"type\": \"dry\"}", drift},
    {"late", "time that 99 % of the steps take at most over the time step", "1", 1.0,
     "it is late: a step takes {} of its time",
     "fewer points, rendering.reduction, a cheaper law; \"hapbench run --latency\" has the distribution",
     [](const RunFiles& r) { return quotient(r.step_time, r.scenario().time.step); }},
};

}  // namespace

std::span<const ExplainRule> explain_rules() {
  return kRules;
}

std::vector<Explanation> explained(const RunFiles& run) {
  std::vector<Explanation> findings;
  for (const ExplainRule& rule : kRules) {
    const RuleNumber value = rule.value(run);
    if (!value || !(*value > rule.threshold)) continue;
    std::string says = fmt::format(fmt::runtime(rule.says), fmt::format("{:.3g}", *value));
    const std::string more = rule.more != nullptr ? rule.more(run) : "";
    findings.push_back({&rule, *value, more.empty() ? says : says + ", " + more});
  }
  return findings;
}

}  // namespace hapbench
