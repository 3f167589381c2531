#include "scenarios/run/quantity_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

struct Unit {
  double per_metre;
  const char* name;
};

/// Returns the unit in which a length has few digits before the decimal point.
Unit unit_for(double metres) {
  const double size = std::abs(metres);
  if (size >= 1.0 || size == 0.0) return {1.0, "m"};
  return size >= 1e-4 ? Unit{1e3, "mm"} : Unit{1e6, "um"};
}

}  // namespace

std::string length_text(double metres) {
  const Unit unit = unit_for(metres);
  return fmt::format("{:.3g} {}", metres * unit.per_metre, unit.name);
}

std::string position_text(const Vec3& position) {
  const Vec3 p = 1e3 * position;
  return fmt::format("({:.3g}, {:.3g}, {:.3g}) mm", p.x(), p.y(), p.z());
}

std::string size_text(const Box& box) {
  const Unit unit = unit_for(box.size().maxCoeff());
  const Vec3 n = box.size() * unit.per_metre;
  return fmt::format("{:.3g} x {:.3g} x {:.3g} {}", n.x(), n.y(), n.z(), unit.name);
}

std::string bounds_text(const Box& box) {
  const Unit unit = unit_for(std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()));
  const Vec3 a = box.min * unit.per_metre, b = box.max * unit.per_metre;
  return fmt::format("x {:.3g} ... {:.3g}, y {:.3g} ... {:.3g}, z {:.3g} ... {:.3g} {}", a.x(), b.x(), a.y(), b.y(),
                     a.z(), b.z(), unit.name);
}

}  // namespace hapbench
