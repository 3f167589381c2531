#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "scenarios/studies/precision/measure.hpp"

namespace hapbench {
namespace {

constexpr int kExact = -1;  // in place of a number of iterations
constexpr int kIterations[] = {0, 1, 2, 3, 4, 5, 10, 20, 40, 80, 160, kExact};

Mat3 shape(ContactBuffer& contacts, int iterations) {
  if (iterations != kExact) return shape_weights(contacts, iterations);
  solve_exact_shaping(contacts);
  return stiffness_tensor(contacts);
}

PrecisionRow measure(int iterations, std::vector<ContactBuffer>& sets, const std::vector<Mat3>& optimum,
                     int repetitions) {
  double squares = 0.0, largest = 0.0, ratio = 0.0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const Mat3 S = shape(sets[i], iterations);
    const double error = (S - optimum[i]).norm();
    squares += error * error / static_cast<double>(sets.size());
    largest = std::max(largest, error);
    const RatioRange range = ratio_range(sets[i], S);
    ratio = std::max({ratio, std::abs(range.min - 1.0), std::abs(range.max - 1.0)});
  }
  const double seconds = seconds_per_call(sets.size(), repetitions, [&] {
    for (ContactBuffer& set : sets) shape(set, iterations);
  });
  return {iterations == kExact ? "exact" : fmt::format("m={}", iterations),
          "completes",
          {std::sqrt(squares), largest, ratio},
          seconds};
}

}  // namespace

static PrecisionResult study_shaping(const Scenario& scenario, const PrecisionOptions& options) {
  std::vector<ContactBuffer> sets = drill_contact_sets(scenario);
  std::vector<Mat3> optimum;
  for (ContactBuffer& set : sets) optimum.push_back(shape(set, kExact));

  PrecisionResult result;
  result.columns = {"tensor_error_rms", "tensor_error_max", "ratio_error_max"};
  result.timed = "call";
  for (const int iterations : kIterations)
    result.add(measure(iterations, sets, optimum, options.repetitions), options, std::size(kIterations));
  return result;
}

const PrecisionStudy kShapingStudy = {
    "shaping", "shaping iterations against the exact optimum, on the contacts of a drill turned in a hole",
    "rotate_in_hole", study_shaping};

}  // namespace hapbench
