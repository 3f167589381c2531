#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"

/// The columns of the tables that commands write beside the files of single runs. Those who write them take their
/// headers from here.
namespace hapbench {

inline constexpr Column kStabilityLimitColumns[] = {
    {"case", "", "what grows until the run is unstable: stiffness, damping or time step"},
    {"unit", "", "unit of the limit"},
    {"analytic", "unit", "the limit in closed form; empty where the integrator has none"},
    {"eigenvalue", "unit", "by bisection on the eigenvalues of a step"},
    {"simulation", "unit", "by bisection on runs"},
    {"damping_at_limit_N_s_per_m", "N s/m", "B at the limit"},
    {"lambda_max", "1", "largest eigenvalue of S: stiffness of the springs in units of K"}};

inline constexpr Column kRootLocusColumns[] = {{"case", "", "what grows"},
                                               {"value", "unit", "its value, in the unit of the case in limits.csv"},
                                               {"first_real", "1", "real part of an eigenvalue of a step"},
                                               {"first_imaginary", "1", "its imaginary part"},
                                               {"second_real", "1", "real part of the other eigenvalue"},
                                               {"second_imaginary", "1", "its imaginary part"},
                                               {"spectral_radius", "1", "largest |eigenvalue|; above 1: unstable"}};

/// {x} and {y} are the names of the map's axes.
inline constexpr Column kStabilityMapColumns[] = {
    {"algorithm", "", "force algorithm"},
    {"{x}", "by name", "x of the map"},
    {"{y}", "by name", "y of the map"},
    {"class", "", "what became of the motion (describe stability)"},
    {"lambda_max", "1", "largest eigenvalue of S in the first row"},
    {"stability_margin", "1",
     "4 - 2 lambda B dt / M - lambda K dt^2 / M under leapfrog: below 0 unstable; empty without theory"},
    {"integrator", "", "integrator"},
    {"class_from_far", "",
     "what became of the motion from a thousand times as far; empty where a map has no such runs"},
    {"overrides", "", "of time step, device and hand, as --set gave them; empty without"}};

/// With one for each limit of the stiffness that is known (stiffness_limits.hpp).
std::span<const Column> stability_boundary_columns();

inline constexpr Column kStressColumns[] = {
    {"algorithm", "", "force algorithm"},
    {"sets", "1", "random contact sets drawn"},
    {"in_contact", "1", "sets whose tool touches a point"},
    {"non_finite", "1", "answers that are not finite"},
    {"out_of_bound", "1", "finite answers beyond what the law allows"},
    {"points_dropped", "1", "contacts that a full reduction refused"},
    {"largest_force_per_K_d", "1", "largest ||f_spring|| in units of K times the set's deepest penetration"},
    {"largest_share_of_bound", "1", "largest ||f_spring|| in units of the law's bound; empty for laws without one"}};

/// Of the tables of `limit` and `compare --devices`.
inline constexpr Column kInconsistentColumn = {
    "inconsistent_runs", "1", "runs that are unstable on the stable side of the limit, or stable beyond it"};

std::vector<Column> limit_columns();
std::span<const Column> limit_run_columns();
std::vector<Column> device_limit_columns();
std::vector<Column> device_run_columns();

/// The header of a stability map's table.
std::string map_header(std::span<const Column> columns, const std::string& x, const std::string& y);

/// A table that `describe` knows.
struct DescribedTable {
  std::string file, holds;
  std::vector<Column> columns;
};

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
