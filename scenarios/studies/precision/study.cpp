#include "scenarios/studies/precision/study.hpp"

namespace hapbench {
namespace {

constexpr PrecisionStudy kStudies[] = {
    {"integrators",
     "every integrator on springs against the exact solution, over the time step; energy without damping",
     "springs_oscillation", study_integrators},
    {"time_step", "a drill turned in a hole against a time step 64 times finer, over the time step",
     "task2_rotate_signed_distance", study_time_step},
    {"shaping", "shaping iterations against the exact optimum, on the contacts of a drill turned in a hole",
     "task2_rotate_signed_distance", study_shaping},
    {"spacing", "shell spacing and density against the ideal trajectory", "task2_rotate_signed_distance",
     study_spacing},
    {"reduction", "gradient-based reduction against exact shaping of all contacts", "task2_rotate_signed_distance",
     study_reduction},
    {"merging", "reduced, merged and all contacts, from dozens to hundreds", "task2_rotate_signed_distance",
     study_merging},
    {"algorithms", "every algorithm against the ideal trajectory", "task2_rotate_signed_distance", study_algorithms},
    {"stiffness", "every algorithm in a wedge against closed forms: stiffness along the contacts and the way out",
     "wedge_stiffness", study_stiffness},
};

}  // namespace

std::span<const PrecisionStudy> precision_studies() {
  return kStudies;
}

}  // namespace hapbench
