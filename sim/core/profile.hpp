#pragma once

#include <utility>
#include <variant>
#include <vector>

namespace hapbench {

/// A scalar function of time, evaluated at any t [s] in O(1), for waypoints O(log n). The value's unit is the owner's.
class Profile {
 public:
  struct Constant {
    double value = 0.0;

    double at(double) const noexcept { return value; }
    double rate(double) const noexcept { return 0.0; }
  };
  /// start + rate_per_s * t
  struct Ramp {
    double start = 0.0;
    double rate_per_s = 0.0;

    double at(double t) const noexcept { return start + rate_per_s * t; }
    double rate(double) const noexcept { return rate_per_s; }
  };
  /// mean + amplitude * sin(2 pi t / period_s + phase_rad)
  struct Sine {
    double mean = 0.0;
    double amplitude = 0.0;
    double period_s = 1.0;
    double phase_rad = 0.0;

    double at(double t) const noexcept;
    double rate(double t) const noexcept;
  };
  enum class Interpolation { linear, cosine };
  /// (t [s], value) with strictly increasing times, held constant outside; `cosine` starts and ends each leg at rest.
  struct Waypoints {
    std::vector<std::pair<double, double>> points;
    Interpolation interpolation = Interpolation::linear;

    double at(double t) const noexcept;
    double rate(double t) const noexcept;
  };
  using Shape = std::variant<Constant, Ramp, Sine, Waypoints>;

  Profile() = default;
  Profile(double value) : shape_(Constant{value}) {}  // NOLINT: implicit, a number is a profile
  Profile(Shape shape) : shape_(std::move(shape)) {}  // NOLINT: implicit, a shape is a profile

  double operator()(double t) const noexcept;
  /// Time derivative at t [unit of the value / s]; at a waypoint, that of the leg that begins there.
  double rate(double t) const noexcept;
  const Shape& shape() const { return shape_; }
  bool is_constant() const { return std::holds_alternative<Constant>(shape_); }

 private:
  Shape shape_{Constant{}};
};

}  // namespace hapbench
