#include "device_model/handle_motion.hpp"

#include <cmath>
#include <cstddef>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// x = v S + a P and x' = v + (a - rate v) S after a time, for x'' = a - rate x'.
struct Coast {
  double S, P;
};

Coast coast(double rate, double time) noexcept {
  const double z = rate * time;
  if (z < 0.05) {
    // The next terms are below 1e-14 of the sums.
    const double P =
        0.5 - z * (1.0 / 6 - z * (1.0 / 24 - z * (1.0 / 120 - z * (1.0 / 720 - z * (1.0 / 5040 - z / 40320)))));
    return {time * (1.0 - z * P), time * time * P};
  }
  const double S = -math::expm1(-z) / rate;
  return {S, (time - S) / rate};
}

/// State of the axis, accelerations in place of forces.
struct Axis {
  double rate, grip;
  double x, v;

  void leave_rest(double push, double time) noexcept {
    v = 0.0;
    if (std::abs(push) <= grip || time <= 0.0) return;
    const double net = push - std::copysign(grip, push);
    const Coast by = coast(rate, time);
    x += net * by.P;
    v = net * by.S;
  }

  void advance(double push, double time) noexcept {
    if (v == 0.0) return leave_rest(push, time);
    const double net = push - std::copysign(grip, v);
    const Coast by = coast(rate, time);
    const double after = v + (net - rate * v) * by.S;
    if (grip == 0.0 || after * v >= 0.0) {
      x += v * by.S + net * by.P;
      v = after;
      return;
    }
    const double without = v / (rate * v - net);  // when it stops, were there no viscous friction to change on the way
    const double share = rate * without,
                 stops = share > 1e-9 ? 2.0 * math::atanh(share / (2.0 - share)) / rate : without;
    const Coast to_stop = coast(rate, stops);
    x += v * to_stop.S + net * to_stop.P;
    leave_rest(push, time - stops);
  }
};

}  // namespace

void simulate_log(const LoggedHandle& handle, std::span<const double> times, std::span<const double> forces,
                  std::span<double> positions) noexcept {
  Axis axis{handle.viscous / handle.mass, handle.coulomb / handle.mass, 0.0, handle.velocity};
  double push = handle.offset / handle.mass;
  std::size_t next = 0;  // the force that arrives next
  for (std::size_t k = 0; k < times.size(); ++k) {
    positions[k] = axis.x;
    if (k + 1 == times.size()) break;
    double now = times[k];
    for (; times[next] + handle.delay < times[k + 1]; ++next) {
      const double arrives = times[next] + handle.delay;
      if (arrives > now) axis.advance(push, arrives - now), now = arrives;
      push = (forces[next] + handle.offset) / handle.mass;
    }
    axis.advance(push, times[k + 1] - now);
  }
}

}  // namespace hapbench
