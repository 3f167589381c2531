#include "scenarios/scene/describe_rendering.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

/// Returns the field's name without the path of the objects around it.
std::string_view key(const Parameter& parameter) {
  const std::string_view path = parameter.field;
  return path.substr(path.rfind('.') + 1);
}

/// Returns the range of an integer parameter.
IntegerRange integers(const Parameter& parameter) {
  return {static_cast<std::int64_t>(parameter.range.min), static_cast<std::int64_t>(parameter.range.max)};
}

/// Describes the field of a parameter: an integer, a number, or a number that may be null.
template <class Number>
void number(Fields& f, const Parameter& parameter, Number& value, const char* doc,
            Presence presence = Presence::has_default) {
  if constexpr (std::is_integral_v<Number>)
    f.integer(key(parameter), value, integers(parameter), doc, presence);
  else
    f.number(key(parameter), value, parameter.range, doc, presence);
}

/// Describes a field that is null or has the value that `each(Fields&, T&)` describes. Written scenarios omit the
/// field if the optional is empty.
template <class T, class Each>
void if_not_null(Fields& f, std::string_view name, std::optional<T>& value, const char* doc, Each each) {
  f.nullable(name, value, doc, each, value ? Presence::no_default : Presence::omitted);
}

/// Describes the parameters that belong to one algorithm only.
void algorithm_parameters(Fields& f, RenderingConfig& rendering, const AlgorithmEntry& entry) {
  const std::vector<double> values = parameter_values(rendering, entry);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const AlgorithmParameter& parameter = entry.algorithm_parameters[i];
    // JSON has no infinite numbers: null stands for an infinite default.
    std::optional<double> value;
    if (std::isfinite(values[i])) value = values[i];
    const auto number = [&](Fields& n, double& held) { n.number(held, parameter.range); };
    if (std::isinf(parameter.initial))
      if_not_null(f, parameter.name, value, parameter.meaning, number);
    else
      f.number(parameter.name, *value, parameter.range, parameter.meaning);
    if (f.reads() && f.given(parameter.name))
      rendering.parameters[entry.info->name][parameter.name] = value.value_or(parameter.initial);
  }
}

/// Describes the field `parameters`, which holds an object for each algorithm that has parameters of its own. A written
/// scenario has the objects of the scenario's algorithm and of algorithms whose parameters were given. If a written
/// scenario had the objects of all algorithms, its text would change whenever an algorithm is added.
void algorithm_parameters(Fields& f, RenderingConfig& rendering) {
  const auto presence = [&rendering](const AlgorithmEntry& entry) {
    const bool written = !entry.algorithm_parameters.empty() &&
                         (entry.info->name == rendering.algorithm || rendering.parameters.contains(entry.info->name));
    return written ? Presence::no_default : Presence::omitted;
  };
  const bool any = std::ranges::any_of(algorithms(), [&](auto& entry) { return presence(entry) != Presence::omitted; });
  f.group("parameters", "parameters that belong to one algorithm: an object for each algorithm",
          any ? Presence::no_default : Presence::omitted, [&](Fields& all) {
            for (const AlgorithmEntry& entry : algorithms()) {
              if (entry.algorithm_parameters.empty()) continue;
              all.group(entry.info->name, "parameters of this algorithm", presence(entry),
                        [&](Fields& own) { algorithm_parameters(own, rendering, entry); });
            }
          });
}

}  // namespace

static void describe(Fields& f, ReductionConfig& reduction) {
  number(f, parameter::kThreshold, reduction.threshold,
         "alpha_TH: gradients with an inner product above this value count as similar");
  number(f, parameter::kMaxPoints, reduction.max_points, "n_ext: largest number of points that the reduction keeps");
  f.nullable(key(parameter::kShuffleSeed), reduction.shuffle_seed,
             "seed of a random but fixed order in which the points are visited; null: ascending index",
             [](Fields& s, std::uint64_t& seed) { s.integer(seed, integers(parameter::kShuffleSeed)); });
}

static void describe(Fields& f, DryFrictionConfig& dry) {
  number(f, parameter::kDryMu, dry.mu, "coefficient of dry friction");
  number(f, parameter::kDryStiffness, dry.stiffness,
         "K_t, stiffness of the bristle that holds a sticking tool; null: K");
  number(f, parameter::kDryDampingRatio, dry.damping_ratio,
         "zeta_t, damping ratio of the bristle with the virtual mass");
}

/// Describes the field `friction`: either the thesis's viscous friction, whose defaults depend on the scene, or dry
/// friction.
static void describe_friction(Fields& f, RenderingConfig& rendering) {
  constexpr TypeName kTypes[] = {
      {"viscous", "viscous friction of the thesis, proportional to the velocity (default)"},
      {"dry", "dry friction (not in the thesis): sticks up to mu times the load, and slides above it"}};
  f.alternatives(
      "friction", kTypes, Untyped::first, rendering.dry_friction ? 1 : 0,
      [&rendering](Fields& fields, std::size_t type) {
        if (type == 1) {
          DryFrictionConfig dry = rendering.dry_friction.value_or(DryFrictionConfig{});
          describe(fields, dry);
          if (!fields.reads()) return;
          rendering.dry_friction = dry;
          rendering.mu_s = rendering.mu_f = 0.0;
          return;
        }
        number(fields, parameter::kMuS, rendering.mu_s,
               "mu_s, coefficient of viscous friction independent of the load; default 0 for springs, else 5",
               Presence::no_default);
        number(fields, parameter::kMuF, rendering.mu_f,
               "mu_f, coefficient of viscous friction per newton of spring force; default 0 for springs, else 10",
               Presence::no_default);
      });
}

/// Describes Hunt-Crossley damping with the coefficient `chi`.
static void describe_hunt_crossley(Fields& f, double& chi) {
  constexpr TypeName kTypes[] = {
      {"hunt_crossley",
       "damping force -chi K sum c_i d_i <v, u_i> u_i, which is continuous when contacts begin and end"}};
  f.alternatives("damping", kTypes, Untyped::refused, 0, [&chi](Fields& fields, std::size_t) {
    number(fields, parameter::kChi, chi, "chi, coefficient of the damping", Presence::required);
  });
}

static void describe(Fields& f, MultiRateSchedule& schedule) {
  number(f, parameter::kEvery, schedule.every,
         "contacts are computed in every n-th time step, starting with the first");
  number(f, parameter::kDelay, schedule.delay, "delay, in time steps, from computing the contacts to using them");
  f.choice("between", schedule.linear, {"hold", "linear"}, "kind of contacts between queries",
           "hold: depths stay as computed; linear: depths follow the tool's motion along the gradients");
  number(f, parameter::kDropout, schedule.dropout,
         "probability that the result of a contact query is lost, drawn by the seed; the first result is never lost");
}

/// Describes the source of contacts: a name, or an object that names a file (a recording or a shared library).
static void describe_contact_source(Fields& f, RenderingConfig& rendering) {
  constexpr TypeName kTypes[] = {
      {kTrace, "contacts recorded at times of a prescribed motion"},
      {kContactPlugin, "shared library that implements hapbench_module.h; its code is executed"}};
  std::string& source = rendering.contact_source;
  const bool is_plugin = source == kContactPlugin;
  f.plain_or_object(
      is_plugin || source == kTrace,
      [&](Fields& plain) { plain.choice(source, {kComputedContacts}, "source of contacts"); },
      [&](Fields& object) {
        object.alternatives(
            "source of contacts", kTypes, Untyped::refused, is_plugin ? 1 : 0, [&](Fields& fields, std::size_t type) {
              if (fields.reads()) source = kTypes[type].name;
              using Kind = FileContent::Kind;
              fields.file(
                  rendering.contact_file, {type == 0 ? Kind::trace : Kind::library},
                  type == 0 ? "CSV with the header time_s,x_m,y_m,z_m,ux,uy,uz,depth_m" : "file of the shared library");
              if (type == 0) return;
              fields.field("config", "configuration passed to the library as JSON text", Presence::has_default,
                           [&](Fields& config) { config.any_object(rendering.contact_config); });
            });
      });
}

static void describe(Fields& f, EnergyTankConfig& tank) {
  number(f, parameter::kTankCapacity, tank.capacity, "C, largest energy that the tank stores");
  number(f, parameter::kTankInitial, tank.initial,
         "energy in the tank at the start, in addition to the energy of the springs");
}

static void describe(Fields& f, ActuatorLimitedPassivityConfig& limited) {
  f.nullable(key(parameter::kActuatorForce), limited.max_force,
             "largest force of the actuators along each axis of the world; null: no limit",
             [](Fields& v, Vec3& force) { v.vector3(force, parameter::kActuatorForce.range); });
  number(f, parameter::kActuatorDamping, limited.max_damping,
         "largest damping; null: M / dt, which stops the virtual tool in one time step");
}

static void describe(Fields& f, ForceStageConfig& stage) {
  f.variant(stage, "force stage",
            {{"energy_tank", "the rendering releases no more energy than the tank holds"},
             {"actuator_limited_passivity", "time-domain passivity control within the force limits of each actuator"}});
}

void describe(Fields& f, RenderingConfig& rendering) {
  static const std::vector<std::string> kDepthModels =
      names_of(depth_models(), [](const DepthModelEntry& entry) { return entry.info->name; });
  f.choice("algorithm", rendering.algorithm, algorithm_names(), "algorithm", "force algorithm");
  // Set the stages that the algorithm prescribes. They are the defaults of the fields that are described next.
  if (f.reads()) rendering = with_fixed_stages(rendering);
  number(f, parameter::kIterations, rendering.iterations, "m, number of shaping iterations");
  f.choice("depth_model", rendering.depth_model, kDepthModels, "depth model",
           "default: surface_normal, unless the algorithm's definition requires another depth model",
           Presence::no_default);
  f.field("contact_source",
          "own: hapbench finds the contacts, with the depth model; an object names a file or a library that supplies "
          "contacts, depths and gradients",
          Presence::has_default, [&rendering](Fields& source) { describe_contact_source(source, rendering); });
  if_not_null(
      f, "contacts", rendering.multi_rate,
      "multi-rate rendering: a slower loop computes the contacts; null: contacts are computed in every time step",
      [](Fields& schedule, MultiRateSchedule& value) { schedule.object(value); });
  f.boolean(key(parameter::kLocalAverage), rendering.local_average,
            "true: merges the colliding points of each grid cell of the shell into one point");
  f.object(
      "reduction", rendering.reduction,
      "gradient-based reduction: keeps the deepest of contacts with similar gradients; the kept set changes abruptly; "
      "null: off");
  number(f, parameter::kStiffness, rendering.stiffness, "K, stiffness of one penalty spring");
  number(f, parameter::kDampingRatio, rendering.damping_ratio,
         "zeta, damping ratio of a contact, which gives B = 2 zeta sqrt(K M)");
  number(f, parameter::kDamping, rendering.damping,
         "B, damping of a contact, in place of the value from zeta; null: from zeta");
  f.boolean(
      key(parameter::kAngularDamping), rendering.angular_damping,
      "true: damping and friction use the velocity of the tool's material at each contact; false: of the tip centre");
  number(f, parameter::kAngularVelocityCutoff, rendering.angular_velocity_cutoff,
         "cutoff frequency of a first-order low-pass of the angular velocity used by angular_damping; null: none");
  number(f, parameter::kMass, rendering.mass, "M, mass of the virtual tool; default 0.2 in planar scenes, else 0.1",
         Presence::no_default);
  if_not_null(f, "damping", rendering.hunt_crossley,
              "damping that grows with depth, in place of damping_ratio; null: off", describe_hunt_crossley);
  f.field("friction", "friction along the surface", Presence::has_default,
          [&rendering](Fields& friction) { describe_friction(friction, rendering); });
  f.group("limits", "optional limits of damping and force", Presence::has_default, [&rendering](Fields& limits) {
    number(limits, parameter::kMaxDamping, rendering.max_damping, "B_max, largest damping; null: no limit");
    number(limits, parameter::kMaxForce, rendering.max_force,
           "F_max, largest norm of the rendered force; null: no limit");
  });
  number(f, parameter::kVirtualCoupling, rendering.virtual_coupling,
         "K_vc, stiffness of the coupling spring of algorithm virtual_coupling; null: K");
  number(f, parameter::kRegularisation, rendering.regularisation, "eps, regularisation of algorithm least_squares");
  if_not_null(
      f, "force_stage", rendering.force_stage,
      "force stage after the algorithm: receives the algorithm's force with damping, friction and limits, and computes "
      "the force to render; null: off",
      [](Fields& held, ForceStageConfig& value) { describe(held, value); });
  f.boolean(key(parameter::kPassivityController), rendering.passivity_controller,
            "adaptive damping that prevents the algorithm from creating energy");
  algorithm_parameters(f, rendering);
}

}  // namespace hapbench
