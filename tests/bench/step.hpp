#pragma once

#include <memory>
#include <string>

#include "results/observe/metrics.hpp"
#include "results/observe/passivity_observer.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench::bench {

/// The runs whose steps are timed.
inline constexpr const char* kSteps[] = {"T1",
                                         "T2",
                                         "T2_proxy",
                                         "T3",
                                         "T1_revolved",
                                         "T2_revolved",
                                         "T3_revolved",
                                         "T3_grooved",
                                         "T1_mesh",
                                         "T2_mesh",
                                         "T3_mesh",
                                         "unreduced_1000",
                                         "free_air",
                                         "upright",
                                         "upright_proxy",
                                         "pressed_ideal",
                                         "pressed_impedance"};

/// Steps before the first that is timed: by then T1 has touched the block and every buffer has been used.
inline constexpr std::uint64_t kWarmUp = 1024;

/// A run of one of kSteps as `hapbench run` makes it, with its metrics, and a recorder that keeps in memory what
/// trajectory.csv would say. In `_revolved` the drill is a solid of revolution whose side is cut into eight lines, the
/// same body; in `_grooved` it has grooves of 0.1 um, so that it is not convex but meets nearly the same points.
class TimedRun {
 public:
  explicit TimedRun(const std::string& name, Skips skips = Skips::on);
  ~TimedRun();

  /// Back to the state after kWarmUp steps.
  void rewind() noexcept;
  /// The rest of the run after rewinding.
  std::uint64_t steps_left() const { return steps_ - kWarmUp; }
  /// Whether every step has been taken.
  bool at_end() const { return simulation_->next_row() == steps_; }
  Simulation& simulation() { return *simulation_; }
  const MetricsObserver& metrics() const { return *metrics_; }

 private:
  class MemoryRecorder;

  std::uint64_t steps_ = 0;
  std::unique_ptr<MetricsObserver> metrics_;
  std::unique_ptr<PassivityObserver> passivity_;
  std::unique_ptr<MemoryRecorder> recorder_;
  std::unique_ptr<Simulation> simulation_;
};

/// What is wrong with the first second of the run; empty when nothing. The reference is the run without any skip: brute
/// force, everything computed. Position, velocity and force of every row must be the same bits.
std::string wrong_run(const std::string& name);

}  // namespace hapbench::bench
