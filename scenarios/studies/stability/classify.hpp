#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "results/observe/butterworth.hpp"
#include "sim/loop/observer.hpp"
#include "sim/loop/simulation.hpp"

/// Judges whether a run is stable by its motion alone, without eigenvalues, tensors or knowledge of the law.
///
/// The run is cut into quarters. Their amplitude is the largest speed of the tool in them (of the handle, where it
/// moves the tool: an encoder makes jumps of it that nobody feels); a turn is a change of sign of a component of the
/// velocity, two for each period of an oscillation, whether or not dry friction holds a handle at the turns.
///
///   diverged   the run left its bounds, or it oscillates and its amplitude has grown by more than 1 % from each
///              quarter to the next
///   vibrating  not diverged, and it does not decay: in the last quarter it oscillates (two turns or more of one
///              component) with at least 1 % of the first quarter's amplitude, that is 1e-4 of its energy
///   dying_out  oscillates so, but loses more than a tenth of its amplitude from the second quarter to the third and
///              from the third to the last; an irregular vibration may lose it once, by chance
///   stable     all else: at rest, died out, creeping without a turn
///
/// Both stable and dying_out come to rest if the run goes on long enough, so both count as stable where a limit is
/// looked for. A damped oscillation dies out to 1 % within three quarters of n steps when it loses more than 6.1 / n of
/// its amplitude in a step, and vibrates when it loses less than 0.42 / n: "vibrating" is a thin strip below the limit
/// of a damped linear system, all that is stable of an undamped one, and the limit cycles of a nonlinear one.
namespace hapbench {

enum class MotionClass { stable, dying_out, vibrating, diverged };
inline constexpr std::array kMotionClasses = {MotionClass::stable, MotionClass::dying_out, MotionClass::vibrating,
                                              MotionClass::diverged};

/// "stable", "dying_out", "vibrating", "diverged"
std::string_view motion_class_name(MotionClass motion) noexcept;

/// True of motion that comes to rest: stable, dying_out.
inline bool comes_to_rest(MotionClass motion) noexcept {
  return motion == MotionClass::stable || motion == MotionClass::dying_out;
}

/// Watches a run and classifies it. Constant memory.
class MotionClassifier final : public Observer {
 public:
  /// `steps`: rows the run will have. Precondition: steps >= 4.
  explicit MotionClassifier(std::uint64_t steps) : steps_(steps) {}
  /// Of a tool that a script moves: only what its velocity has above 30 Hz counts (all of it when steps are longer than
  /// a 60th of a second), and in the last quarter only beyond 1 mm/s, about what a hand can feel there. Such a tool is
  /// never at rest.
  static MotionClassifier of_moved_tool(std::uint64_t steps, double time_step);

  void on_step(const StepRecord& record) noexcept override;

  /// True once the tool has come to rest to 1e-12 of its largest speed for 200 rows: what is left is rounding, and the
  /// run may be cut short.
  bool at_rest() const noexcept { return !is_moved_ && rows_at_rest_ >= kRowsAtRest; }
  /// Class of a complete run, or of one that was cut short because it came to rest.
  MotionClass motion_class(Outcome outcome) const noexcept;

 private:
  static constexpr int kRowsAtRest = 200;

  struct Quarter {
    double amplitude = 0.0;                ///< largest speed [m/s]
    std::array<std::uint64_t, 3> turns{};  ///< of each component
  };
  bool oscillates_in(const Quarter& quarter) const noexcept;

  std::uint64_t steps_;
  bool is_moved_ = false;
  std::optional<HighPass> high_pass_;
  std::array<Quarter, 4> quarters_{};
  Vec3 last_velocity_ = Vec3::Zero();  ///< of each component the last that was not zero
  double largest_speed_ = 0.0;
  int rows_at_rest_ = 0;
};

/// Steps the simulation, which `classifier` observes, until it ends or comes to rest. Throws Stopped (stop_signal.hpp).
MotionClass classify(Simulation& simulation, const MotionClassifier& classifier);

}  // namespace hapbench
