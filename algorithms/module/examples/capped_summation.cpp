/* A force law in C++ with hapbench's library: the sum of all springs, scaled down if its stiffness exceeds a limit.
 * Build from this folder, with hapbench installed in /usr (elsewhere: -IPREFIX/include/hapbench and -LPREFIX/lib):
 *
 *     g++ -std=c++20 -O2 -fPIC -shared -ffp-contract=off -DEIGEN_DONT_VECTORIZE -I/usr/include/hapbench \
 *         -I/usr/include/eigen3 capped_summation.cpp -lhapbench_algorithms -lhapbench_sim -o capped_summation.so
 *     hapbench --module ./capped_summation.so compare peg_in_hole_2d_shaped_stiffness
 *
 * With CMake, which adds the flags: find_package(hapbench), add_library(capped_summation MODULE capped_summation.cpp),
 * target_link_libraries(capped_summation PRIVATE hapbench::algorithms). */
#include <algorithm>
#include <algorithms/module/law_module.hpp>

namespace {

constexpr HapbenchParameter kParameters[] = {{
    .name = "limit",
    .unit = "1",
    .min = 0.01,
    .max = 1000.0,
    .initial = 1.0,
    .meaning = "the greatest stiffness in any direction, in units of K",
}};

class CappedSummation final : public hapbench::ExternalForceLaw {
 public:
  CappedSummation(double stiffness, const double* values) : ExternalForceLaw(stiffness), limit_(values[0]) {}

  hapbench::LawForce evaluate(hapbench::ContactBuffer& contacts) override {
    hapbench::set_weights(contacts, 1.0);
    const double stiffest = hapbench::lambda_max(hapbench::stiffness_tensor(contacts));
    hapbench::set_weights(contacts, std::min(1.0, limit_ / stiffest));
    return hapbench::weighted_force(contacts, K_);
  }

 private:
  double limit_;
};

}  // namespace

const HapbenchModule* hapbench_module(uint32_t version) {
  static const HapbenchModule module = hapbench::law_module<CappedSummation>(
      {
          .name = "capped_summation",
          .summary = "the sum of all penalty springs, scaled down to a greatest stiffness",
          .formula = "c_i = min(1, limit / lambda_max(sum u u^T))",
          .source = "example of law_module.hpp",
          .known_failure = "one scale for all directions: those with few points become soft",
      },
      kParameters);
  return version == HAPBENCH_MODULE_VERSION ? &module : nullptr;
}
