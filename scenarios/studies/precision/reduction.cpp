#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/stages/point_stage.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/studies/precision/measure.hpp"

namespace hapbench {
namespace {

constexpr double kThresholds[] = {0.9, 0.95, 0.99, 0.995, 0.999, 0.9999};
constexpr double kOff = 2.0;  // no inner product of unit vectors is larger

/// One way to compute a force: a reduction, or none, and a law.
struct ReductionWay {
  double threshold;
  bool exact;
};

Vec3 depth_vector(ContactBuffer& contacts, bool exact, int iterations) {
  if (exact) {
    solve_exact_shaping(contacts);
  } else {
    shape_weights(contacts, iterations);
  }
  return weighted_depth(contacts);
}

class Measurement {
 public:
  Measurement(const std::vector<ContactBuffer>& sets, int iterations)
      : sets_(sets), iterations_(iterations), work_(largest_size(sets)) {
    for (const ContactBuffer& set : sets) {
      work_.assign(set);
      exact_.push_back(depth_vector(work_, true, iterations_));
    }
  }

  PrecisionRow row(const ReductionWay& way, int repetitions) {
    const auto reduction =
        make_gradient_reduction({.threshold = std::min(way.threshold, 1.0), .max_points = 100'000, .shuffle_seed = {}});
    reduction->prepare({});
    const auto load = [&](const ContactBuffer& set) { work_.assign(set); };
    const auto force = [&] {
      if (way.threshold != kOff) reduction->process(work_);
      return depth_vector(work_, way.exact, iterations_);
    };
    double squares = 0.0, scale = 0.0, largest = 0.0, kept = 0.0;
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      load(sets_[i]);
      const double error = (force() - exact_[i]).norm();
      squares += error * error;
      scale += exact_[i].squaredNorm();
      largest = std::max(largest, error);
      kept += static_cast<double>(work_.size()) / static_cast<double>(sets_.size());
    }
    const std::string law = way.exact ? "exact_shaping" : "shaped_stiffness";
    return {way.threshold == kOff ? law + " off" : fmt::format("{} {}", law, way.threshold),
            "completes",
            {kept, std::sqrt(squares / scale), largest},
            seconds_per_force(sets_, repetitions, load, force)};
  }

 private:
  const std::vector<ContactBuffer>& sets_;
  int iterations_;
  ContactBuffer work_;
  std::vector<Vec3> exact_;  ///< sum c d u of the exact optimum over all contacts [m]
};

}  // namespace

static PrecisionResult study_reduction(const Scenario& scenario, const PrecisionOptions& options) {
  const std::vector<ContactBuffer> sets = drill_contact_sets(scenario);
  Measurement measurement(sets, scenario.rendering.iterations);
  std::vector<ReductionWay> ways;
  for (const bool exact : {false, true}) {
    for (const double threshold : kThresholds) ways.push_back({threshold, exact});
    ways.push_back({kOff, exact});
  }
  PrecisionResult result;
  result.columns = {"kept_mean", "force_error_relative", "depth_error_max_m"};
  result.timed = "call";
  for (const ReductionWay& way : ways) result.add(measurement.row(way, options.repetitions), options, ways.size());
  return result;
}

const PrecisionStudy kReductionStudy = {"reduction", "gradient-based reduction against exact shaping of all contacts",
                                        "rotate_in_hole", study_reduction};

}  // namespace hapbench
