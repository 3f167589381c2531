#pragma once

#include <span>

namespace hapbench {

/// One axis of an impedance device in open loop, as HandleMotion moves it: m x'' = u(t - delay) + offset - b x' - c
/// sign(x').
struct LoggedHandle {
  double mass = 1.0;      ///< m, of all that moves [kg]
  double viscous = 0.0;   ///< b [N s/m]
  double coulomb = 0.0;   ///< c [N]
  double delay = 0.0;     ///< from a row of the log to its force [s]
  double offset = 0.0;    ///< a constant force besides the commands [N]
  double velocity = 0.0;  ///< at the first time [m/s]
};

/// Simulates a log: the positions [m] at `times` [s] of a handle that starts at 0, under forces [N] that are commanded
/// at these times, arrive late and are held; before the first arrives there is none. Exact, stops and rests included.
/// Precondition: times increase, and there are as many forces, times and positions. Takes 20 ns for each time; a
/// simulation is one of some thousand that a least-squares fit needs.
void simulate_log(const LoggedHandle& handle, std::span<const double> times, std::span<const double> forces,
                  std::span<double> positions) noexcept;

}  // namespace hapbench
