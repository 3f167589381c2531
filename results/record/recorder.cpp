#include "results/record/recorder.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "results/observe/energy.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/inside_observer.hpp"
#include "results/observe/six_dof_metrics.hpp"
#include "results/observe/target_metrics.hpp"
#include "sim/contact/contact_buffer.hpp"

namespace hapbench {
namespace {

/// Pairs columns of trajectory.csv with the function that computes their values in a step. The function returns a
/// number for a single column, or a vector with one component for each column.
template <std::size_t n, class Cells>
constexpr std::pair<std::array<Column, n>, Cells> filled(const Column (&columns)[n], Cells cells) {
  return {std::to_array(columns), cells};
}

/// Columns that every trajectory.csv has.
constexpr auto kCommonColumns = std::tuple{
    filled({kStepColumn}, [](const StepRecord& r) { return r.step; }),
    filled({kTimeColumn}, [](const StepRecord& r) { return r.time; }),
    filled({{"px_m", "m", "x of the tip's centre"},
            {"py_m", "m", "y of the tip's centre"},
            {"pz_m", "m", "z of the tip's centre"}},
           [](const StepRecord& r) -> const Vec3& { return r.tool.pose.position; }),
    filled({{"vx_m_per_s", "m/s", "x of the tip centre's velocity"},
            {"vy_m_per_s", "m/s", "y of the tip centre's velocity"},
            {"vz_m_per_s", "m/s", "z of the tip centre's velocity"}},
           [](const StepRecord& r) -> const Vec3& { return r.tool.velocity; }),
    filled({{"axis_x", "1", "x of the tool's axis, the unit vector that points out of the tip"},
            {"axis_y", "1", "y of the tool's axis"},
            {"axis_z", "1", "z of the tool's axis"}},
           [](const StepRecord& r) -> const Vec3& { return r.tool.pose.axis; }),
    filled({{"fx_N", "N", "x of f = f_render, the rendered force on the tool"},
            {"fy_N", "N", "y of f"},
            {"fz_N", "N", "z of f"}},
           [](const StepRecord& r) -> const Vec3& { return r.force.rendered; }),
    filled({{"fspring_x_N", "N",
             "x of f_spring, the spring force: the rendered force f before damping, friction and limits"},
            {"fspring_y_N", "N", "y of f_spring"},
            {"fspring_z_N", "N", "z of f_spring"}},
           [](const StepRecord& r) -> const Vec3& { return r.force.spring; }),
    filled({{"fmeas_x_N", "N", "x of f_meas, the hand force that the force sensor measured"},
            {"fmeas_y_N", "N", "y of f_meas"},
            {"fmeas_z_N", "N", "z of f_meas"}},
           [](const StepRecord& r) -> const Vec3& { return r.hand.measured; }),
    filled(
        {{"fin_x_N", "N", "x of f_in, the measured hand force after the input-force limiter; f_in + f moves the tool"},
         {"fin_y_N", "N", "y of f_in"},
         {"fin_z_N", "N", "z of f_in"}},
        [](const StepRecord& r) -> const Vec3& { return r.hand.input; }),
    filled({{"hx_m", "m", "x of the handle"}, {"hy_m", "m", "y of the handle"}, {"hz_m", "m", "z of the handle"}},
           [](const StepRecord& r) -> const Vec3& { return r.handle.position; }),
    filled({{"hvx_m_per_s", "m/s",
             "x of the handle's true velocity, not the velocity measured by encoder and filter of an impedance device"},
            {"hvy_m_per_s", "m/s", "y of the handle's velocity"},
            {"hvz_m_per_s", "m/s", "z of the handle's velocity"}},
           [](const StepRecord& r) -> const Vec3& { return r.handle.velocity; }),
    filled(
        {{"colliding", "1", "number of points inside the tool or on its surface, before local average and reduction"}},
        [](const StepRecord& r) { return r.colliding; }),
    filled({{"rendered", "1", "number of rendered points, which the force law receives"}},
           [](const StepRecord& r) { return r.rendered->size(); }),
    filled({{"depth_max_m", "m", "largest penetration depth of a colliding point; 0 without contact"}},
           [](const StepRecord& r) { return r.force.depth_max; }),
    filled({{"ratio_min", "1", "smallest stiffness ratio u^T S u of a rendered contact; empty without contact"}},
           [](const StepRecord& r) { return if_any(!r.rendered->empty(), r.ratio.min); }),
    filled({{"ratio_max", "1", "largest stiffness ratio u^T S u of a rendered contact; empty without contact"}},
           [](const StepRecord& r) { return if_any(!r.rendered->empty(), r.ratio.max); })};

/// Returns the unit quaternion (w, x, y, z), with w >= 0, of a rotation.
std::array<double, 4> quaternion(const Mat3& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
}

constexpr Column kPoseColumns[] = {
    {"qw", "1",
     "w of the unit quaternion that rotates the tool's frame (tool axis along -z) into the world's frame; w >= 0"},
    {"qx", "1", "x of the unit quaternion of the orientation"},
    {"qy", "1", "y of the unit quaternion of the orientation"},
    {"qz", "1", "z of the unit quaternion of the orientation"}};
constexpr Column kTorqueColumns[] = {
    {"tx_Nm", "Nm",
     "x of the lost torque tau = sum r_i x f_i about the tip's centre, with contact i's contribution f_i to f_spring: "
     "torque that the contacts exert and a 3-DOF device cannot render"},
    {"ty_Nm", "Nm", "y of the lost torque"},
    {"tz_Nm", "Nm", "z of the lost torque"}};
constexpr Column kInsideColumns[] = {
    {"inside_m", "m",
     "distance of the tool's deepest point below the environment's surface (inside_max_m is its maximum); empty for "
     "springs and beyond the boundary edges of an open surface"},
    {"centre_inside", "1",
     "1 if the tip's centre is below the surface, 0 if it is not; empty for springs and beyond the boundary edges of "
     "an open surface"}};

constexpr TrajectoryGroup kGroups[] = {
    {&TrajectoryExtras::pose, "pose", "add the tool's orientation to trajectory.csv, as a quaternion qw,qx,qy,qz",
     kPoseColumns,
     [](const StepRecord& r, const InsideObserver*, std::optional<double>* cells) {
       const ToolPose pose{r.tool.pose.position, r.tool.pose.axis, r.roll};
       std::ranges::copy(quaternion(pose.rotation()), cells);
     },
     true},
    {&TrajectoryExtras::torque, "torque",
     "add the lost torque tx_Nm,ty_Nm,tz_Nm to trajectory.csv, and its metrics: torque of the rendered contacts about "
     "the tip centre, which a 3-DOF device cannot render",
     kTorqueColumns,
     [](const StepRecord& r, const InsideObserver*, std::optional<double>* cells) {
       std::copy(r.springs.moment.begin(), r.springs.moment.end(), cells);
     },
     false, true},
    {&TrajectoryExtras::inside, "inside",
     "add the depth of the tool in the environment, inside_m, to trajectory.csv, and compute its metrics from every "
     "recorded step",
     kInsideColumns, [](const StepRecord&, const InsideObserver* inside, std::optional<double>* cells) {
       cells[0] = inside != nullptr ? inside->depth() : std::nullopt;
       cells[1] = inside != nullptr ? inside->centre_inside() : std::nullopt;
     }}};

/// Returns the columns that trajectory.csv has with these extras: the common columns, followed by the columns of each
/// requested group.
std::vector<Column> trajectory_columns(const TrajectoryExtras& extras) {
  std::vector<Column> columns;
  const auto add = [&columns](const auto& more) { columns.insert(columns.end(), more.begin(), more.end()); };
  std::apply([&](const auto&... part) { (add(part.first), ...); }, kCommonColumns);
  for (const TrajectoryGroup& group : kGroups)
    if (extras.*group.is_wanted) add(group.columns);
  return columns;
}

/// Returns the documentation of trajectory.csv: all columns, and the scenario fields that add optional columns.
ResultTable whole_trajectory() {
  ResultTable whole{"trajectory.csv", "one line per recorded time step, before the integrator moves the tool", {}};
  TrajectoryExtras all;
  for (const TrajectoryGroup& group : kGroups) {
    const std::string first = group.columns.front().name, last = group.columns.back().name;
    whole.holds += fmt::format("{} {}{} with record.{}", &group == kGroups ? ";" : ",", first,
                               first == last ? "" : " to " + last, group.field);
    all.*group.is_wanted = true;
  }
  whole.columns = trajectory_columns(all);
  return whole;
}

}  // namespace

std::span<const TrajectoryGroup> trajectory_groups() {
  return kGroups;
}

const ResultTable kTrajectoryTable = whole_trajectory();
const ResultTable kContactTable = {
    "contacts.csv",
    "with record.contacts: one line per rendered contact of each recorded time step",
    {kStepColumn,
     kTimeColumn,
     {"index", "1",
      "index of the shell point or spring, from 0; of contacts from another library: index of the triangle"},
     {"x_m", "m", "x of the colliding point"},
     {"y_m", "m", "y of the colliding point"},
     {"z_m", "m", "z of the colliding point"},
     {"nx", "1", "x of the environment's outward unit normal at the colliding point"},
     {"ny", "1", "y of the environment's outward unit normal at the colliding point"},
     {"nz", "1", "z of the environment's outward unit normal at the colliding point"},
     {"depth_m", "m", "penetration depth d, by the depth model"},
     {"gradient_x", "1", "x of the unit gradient u, the direction in which the point would leave the tool"},
     {"gradient_y", "1", "y of the unit gradient u"},
     {"gradient_z", "1", "z of the unit gradient u"},
     {"weight", "1", "weight c_i that the force law gave to the contact; 0 for laws without weights"}}};
const ResultTable kContactTraceTable = {
    "contact_trace.csv",
    "with record.contacts: one line per colliding point of each recorded time step, before local average and "
    "reduction; rendering.contact_source of type trace reads this file",
    {kTimeColumn,
     {"x_m", "m", "x of the colliding point"},
     {"y_m", "m", "y of the colliding point"},
     {"z_m", "m", "z of the colliding point"},
     {"ux", "1", "x of the unit gradient u, the direction in which the tool would move deeper"},
     {"uy", "1", "y of the unit gradient u"},
     {"uz", "1", "z of the unit gradient u"},
     {"depth_m", "m", "penetration depth d, by the depth model"}}};
const ResultTable kStiffnessTable = {
    "stiffness_tensor.csv",
    "with record.stiffness_tensor: one line per recorded time step",
    {kStepColumn,
     kTimeColumn,
     {"sxx", "1", "element xx of the stiffness tensor S = sum c u u^T of the rendered contacts, in units of K"},
     {"sxy", "1", "element xy of S"},
     {"sxz", "1", "element xz of S"},
     {"syy", "1", "element yy of S"},
     {"syz", "1", "element yz of S"},
     {"szz", "1", "element zz of S"},
     {"lambda_max", "1", "largest eigenvalue of S: largest combined stiffness in any direction, in units of K"}}};
const ResultTable kRatioTable = {
    "ratios.csv",
    "with record.ratio_iterations: one line per iteration of each recorded time step in contact",
    {kStepColumn,
     kTimeColumn,
     {"iteration", "1", "number m of shaping iterations, starting from weights of 1"},
     {"rendered", "1", "number of rendered points, which the force law receives"},
     {"ratio_min", "1", "smallest stiffness ratio u^T S u of a rendered contact after m updates"},
     {"ratio_max", "1", "largest stiffness ratio u^T S u of a rendered contact after m updates"},
     {"lambda_max", "1", "largest eigenvalue of S after m updates: largest combined stiffness in units of K"}}};
const ResultTable kEnergyTable = {
    "energy.csv",
    "with record.energy: the energy balance, one line per recorded time step",
    {kStepColumn,
     kTimeColumn,
     {"kinetic_J", "J", "kinetic energy of the virtual mass at this time"},
     {"stored_J", "J", "elastic energy of the penalty springs at this time"},
     {"input_J", "J", "work of f_in on the tool since the first step"},
     {"spring_J", "J", "work of f_spring on the tool since the first step"},
     {"damping_J", "J", "work of damping, friction and force limit (of f - f_spring) on the tool since the first step"},
     {"rotation_J", "J", "work that the tool's rotation did on the springs since the first step"},
     {"created_J", "J",
      "created energy since the first step: energy stored in the springs, minus the work that translation and "
      "rotation did on them"},
     {"integration_J", "J", "energy created by the numerical integrator since the first step"},
     {"script_J", "J", "work of the scripted motion since the first step"},
     {"residual_J", "J",
      "kinetic energy that the other terms do not explain; in a correct balance only rounding errors"},
     {"hand_J", "J", "work of the hand on the handle since the first step"},
     {"actuator_J", "J", "work of the device's actuators since the first step"},
     {"device_dissipated_J", "J",
      "work of the friction in the device's mechanics since the first step; negative: dissipated; empty if handle and "
      "tool are one body"},
     {"device_stored_J", "J",
      "energy stored in the device's mechanics at this time; empty if handle and tool are one body"}}};
const ResultTable kIdealTrajectoryTable = {
    "ideal_trajectory.csv",
    "with record.ideal_trajectory: one line per recorded time step at whose tilt the ideal trajectory exists",
    {kStepColumn,
     kTimeColumn,
     {"tilt_rad", "rad", "angle between the tool's axis and the hole's axis"},
     {"height_m", "m", "height of the tip's centre above the hole's mouth; negative inside the hole"},
     {"ideal_height_m", "m", "height of the tip's centre on the ideal trajectory at the same tilt"},
     {"lateral_m", "m",
      "distance of the tip's centre from the hole's axis, positive in the direction in which the tool leans"},
     {"ideal_lateral_m", "m",
      "distance of the tip's centre from the hole's axis on the ideal trajectory at the same tilt"},
     {"interpenetration_m", "m",
      "depth of the tool in the exact block, computed from the shapes and not from the shell"},
     {"hand_force_N", "N", "norm of the hand's force"}}};
const ResultTable kForceReferenceTable = {
    "force_reference.csv",
    "with record.force_reference: the reference force, one line per recorded time step",
    {kStepColumn,
     kTimeColumn,
     {"mfx_N", "N", "x of the reference force f_m on the tool; empty if no force was measured"},
     {"mfy_N", "N", "y of f_m"},
     {"mfz_N", "N", "z of f_m"},
     {"force_error_x_N", "N", "x of the force error f - f_m"},
     {"force_error_y_N", "N", "y of f - f_m"},
     {"force_error_z_N", "N", "z of f - f_m"}}};
const ResultTable kSixDofTable = {
    "six_dof.csv",
    "with record.six_dof: a 6-DOF device and the law on a 3-DOF device, one line per recorded time step; cells are "
    "empty where there is no equilibrium",
    {kStepColumn,
     kTimeColumn,
     {"reference_x_N", "N", "x of the force of the 6-DOF device on its handle"},
     {"reference_y_N", "N", "y of the force of the 6-DOF device"},
     {"reference_z_N", "N", "z of the force of the 6-DOF device"},
     {"torque_x_Nm", "N m", "x of the torque of the 6-DOF device on its handle, about the force point"},
     {"torque_y_Nm", "N m", "y of the torque of the 6-DOF device"},
     {"torque_z_Nm", "N m", "z of the torque of the 6-DOF device"},
     {"tool_x_m", "m", "x of the tip centre of the 6-DOF device's tool"},
     {"tool_y_m", "m", "y of the tip centre of the 6-DOF device's tool"},
     {"tool_z_m", "m", "z of the tip centre of the 6-DOF device's tool"},
     {"tool_axis_x", "1", "x of the axis of the 6-DOF device's tool"},
     {"tool_axis_y", "1", "y of the axis of the 6-DOF device's tool"},
     {"tool_axis_z", "1", "z of the axis of the 6-DOF device's tool"},
     {"handle_turn_x_rad", "rad", "x of the rotation vector by which the torque turns the 6-DOF device's handle"},
     {"handle_turn_y_rad", "rad", "y of this rotation vector"},
     {"handle_turn_z_rad", "rad", "z of this rotation vector"},
     {"law_x_N", "N", "x of the force of the law on the handle of the 3-DOF device"},
     {"law_y_N", "N", "y of the force of the law"},
     {"law_z_N", "N", "z of the force of the law"}}};
const ResultTable kTargetTable = {
    "targets.csv",
    "with a hand of type tracking: one line per target of every trial",
    {{"subject", "1", "index of the simulated subject, from 0"},
     {"trial", "1", "index of the subject's trial, from 0"},
     {"target", "1", "index of the target in the trial, from 0"},
     {"place", "1", "position of the target: index in the task's list of places"},
     {"removed", "1", "1 if the subject removed the target, 0 if it disappeared at the time limit"},
     {"time_s", "s", "time from the press that activated the task to the end of the target"},
     {"rows_on_target", "1", "number of steps with the tip on the target"},
     {"model_force_N", "N", "mean ||f|| over the steps with the tip on the target; empty if there are no such steps"},
     {"speed_m_per_s", "m/s",
      "mean speed of the handle over the steps with the tip on the target; empty if there are no such steps"}}};

Recorder::Recorder(const TableTarget& target, RowSource source, std::uint64_t every)
    : source_(std::move(source)), writer_(target, source_.columns), every_(every) {
  assert(every > 0);
}

RowSource trajectory_rows(const TrajectoryExtras& extras, const InsideObserver* inside) {
  RowSource source = {.columns = trajectory_columns(extras), .write = {}, .wants_ratio = true};
  std::vector<const TrajectoryGroup*> groups;
  std::vector<std::optional<double>> more;
  for (const TrajectoryGroup& group : kGroups) {
    if (!(extras.*group.is_wanted)) continue;
    groups.push_back(&group);
    more.resize(more.size() + group.columns.size());
    source.wants_roll |= group.wants_roll;
    source.wants_springs |= group.wants_springs;
  }
  source.write = [groups, inside, more](const StepRecord& record, TableWriter& table) mutable {
    std::optional<double>* cells = more.data();
    for (const TrajectoryGroup* group : groups) {
      group->fill(record, inside, cells);
      cells += group->columns.size();
    }
    std::apply([&](const auto&... part) { table.row(part.second(record)..., more); }, kCommonColumns);
  };
  return source;
}

RowSource contact_rows() {
  const auto write = [](const StepRecord& record, TableWriter& table) {
    const ContactBuffer& c = *record.rendered;
    for (std::size_t i = 0; i < c.size(); ++i) {
      table.row(record.step, record.time, std::uint64_t{c.index[i]}, c.point(i), c.normal(i), c.depth[i], c.gradient(i),
                c.weight[i]);
    }
  };
  return {.columns = kContactTable.columns, .write = write};
}

RowSource contact_trace_rows() {
  const auto write = [](const StepRecord& record, TableWriter& table) {
    const ContactBuffer& c = *record.found;
    for (std::size_t i = 0; i < c.size(); ++i) table.row(record.time, c.point(i), c.gradient(i), c.depth[i]);
  };
  return {.columns = kContactTraceTable.columns, .write = write, .wants_found = true};
}

RowSource stiffness_rows() {
  const auto write = [](const StepRecord& record, TableWriter& table) {
    const Mat3& S = record.force.S;
    table.row(record.step, record.time, S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2), lambda_max(S));
  };
  return {.columns = kStiffnessTable.columns, .write = write};
}

RowSource ratio_rows(std::vector<int> iterations, ShapingOperations shaping, std::size_t capacity) {
  std::sort(iterations.begin(), iterations.end());
  iterations.erase(std::unique(iterations.begin(), iterations.end()), iterations.end());
  assert(iterations.empty() || iterations.front() >= 0);
  const auto write = [iterations = std::move(iterations), shaping, copy = std::make_shared<ContactBuffer>(capacity)](
                         const StepRecord& record, TableWriter& table) {
    if (record.rendered->empty()) return;
    ContactBuffer& contacts = *copy;
    assert(record.rendered->size() <= contacts.capacity());
    contacts.assign(*record.rendered);
    // For each requested number m of updates, make updates until there are m, then write the ratios.
    Mat3 S = shaping.start(contacts);
    int done = 0;
    for (const int m : iterations) {
      for (; done < m; ++done) S = shaping.update(contacts, S);
      const RatioRange ratio = ratio_range(contacts, S);
      table.row(record.step, record.time, static_cast<std::uint64_t>(m), contacts.size(), ratio.min, ratio.max,
                lambda_max(S));
    }
  };
  return {.columns = kRatioTable.columns, .write = write};
}

RowSource energy_rows(const EnergyLedger& ledger) {
  const auto write = [&ledger](const StepRecord& record, TableWriter& table) {
    const EnergyBalance& b = ledger.balance();
    table.row(record.step, record.time, b.kinetic, b.stored, b.input, b.spring, b.damping, b.rotation, b.created,
              b.integration, b.script, b.residual, b.hand, b.actuator,
              b.device ? std::optional(b.device->dissipated) : std::nullopt,
              b.device ? std::optional(b.device->stored) : std::nullopt);
  };
  return {.columns = kEnergyTable.columns, .write = write};
}

RowSource ideal_trajectory_rows(const IdealTrajectoryObserver& observer) {
  const auto write = [&observer](const StepRecord& record, TableWriter& table) {
    if (!observer.error()) return;
    const TrajectoryError& e = *observer.error();
    table.row(record.step, record.time, e.tilt, e.actual.height, e.ideal.height, e.actual.lateral, e.ideal.lateral,
              e.interpenetration, e.hand_force);
  };
  return {.columns = kIdealTrajectoryTable.columns, .write = write};
}

RowSource force_reference_rows(const ForceFidelityObserver& observer) {
  const auto write = [&observer](const StepRecord& record, TableWriter& table) {
    const auto& measured = observer.reference();
    if (measured)
      table.row(record.step, record.time, *measured, Vec3(record.force.rendered - *measured));
    else
      table.row(record.step, record.time, std::array<std::optional<double>, 6>{});
  };
  return {.columns = kForceReferenceTable.columns, .write = write};
}

RowSource six_dof_rows(const SixDofRow& row) {
  const auto write = [&row](const StepRecord& record, TableWriter& table) {
    using Cells = std::array<std::optional<double>, 3>;
    const auto cells = [](bool known, const Vec3& v) {
      return Cells{if_any(known, v.x()), if_any(known, v.y()), if_any(known, v.z())};
    };
    const bool solved = row.reference.has_value(), balanced = row.law.has_value();
    const SixDofRow::Reference reference = row.reference.value_or(SixDofRow::Reference());
    table.row(record.step, record.time, cells(solved, reference.force), cells(solved, reference.torque),
              cells(solved, reference.tip), cells(solved, reference.axis), cells(solved, reference.handle_turn),
              cells(balanced, row.law.value_or(SixDofRow::Law()).force));
  };
  return {.columns = kSixDofTable.columns, .write = write};
}

void write_target_table(const TableTarget& target, const std::vector<TargetRow>& rows, FileSet* together) {
  TableWriter table(target, kTargetTable.columns);
  for (const TargetRow& row : rows) {
    const bool any = row.rows_on_target > 0;
    table.row(std::uint64_t{row.subject}, std::uint64_t{row.trial}, std::uint64_t{row.target},
              std::uint64_t{row.result.position}, std::uint64_t{row.result.removed}, row.result.time,
              row.rows_on_target, if_any(any, row.model_force), if_any(any, row.speed));
  }
  table.finish(together);
}

}  // namespace hapbench
