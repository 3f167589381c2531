#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/run/stuck.hpp"

namespace hapbench {

/// Follows a dragged tool on the path along which it is led.
class DragCourse {
 public:
  /// The hand must outlive it. `width`: the tool's [m]; `duration`: of the run [s].
  DragCourse(const DragHand& hand, double width, double duration);

  /// Adds a row at `time` [s].
  void add(double time) noexcept;

  /// Since when the tool came less than a tenth as far as the point that leads it, over each width that this went on.
  std::optional<Stuck> stuck() const;
  double way() const { return now_.way; }      ///< furthest that the tool came on the path [m]
  double asked() const { return now_.asked; }  ///< how far its hand led it [m]
  /// How far the tool ended behind where its hand led it [m], if that is further than a tenth of the way and than the
  /// tool's half width, and than twice as far as at half way: a tool that friction holds back comes along.
  std::optional<double> left_behind() const;

 private:
  /// The point's and the tool's way at a time.
  struct Stand {
    double time = 0.0, asked = 0.0, way = 0.0;
  };
  static constexpr std::size_t kStands = 4;
  const DragHand& hand_;
  double width_, half_way_;                         ///< [m]
  double behind_ = 0.0, behind_at_half_way_ = 0.0;  ///< the point that leads it [m]
  Stand now_;
  std::array<Stand, kStands> stands_{};  ///< a quarter of the tool's width of the point's way apart
  std::size_t stand_ = 0;                ///< how many there were
  std::optional<Stand> stuck_;           ///< where it came to stand for good
};

}  // namespace hapbench
