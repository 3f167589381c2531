#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/core/profile.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The scripted part of the tool's motion: always its orientation, and its position too when it is prescribed.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Unit vector out of the tip at time t [s].
  virtual Vec3 axis_at(double t) const noexcept = 0;
  /// True when the tip centre is integrated, false when position_at prescribes it.
  virtual bool position_is_free() const noexcept = 0;
  /// Tip centre at time t [m]; called only when the position is not free.
  virtual Vec3 position_at(double t) const noexcept = 0;
};

/// The tool leans by `tilt` from `up` towards `lean` turned by `azimuth` about `up`:
/// axis = -(cos(tilt) up + sin(tilt) lean'), so at tilt 0 the tip points down.
struct Orientation {
  Vec3 up = {0.0, 0.0, 1.0};    ///< unit
  Vec3 lean = {1.0, 0.0, 0.0};  ///< unit, perpendicular to up
  Profile tilt;                 ///< [rad]
  Profile azimuth;              ///< [rad], right-handed about up
};

/// The tool's axis at a tilt and an azimuth [rad] of its own, whatever the profiles say.
Vec3 tool_axis(const Orientation& orientation, double tilt, double azimuth) noexcept;

/// Orientation from profiles; position free, or three profiles [m].
class ScriptedMotion final : public Motion {
 public:
  ScriptedMotion(Orientation orientation, std::optional<std::array<Profile, 3>> position);

  Vec3 axis_at(double t) const noexcept override;
  bool position_is_free() const noexcept override { return !position_; }
  Vec3 position_at(double t) const noexcept override;

 private:
  Orientation orientation_;
  std::optional<Vec3> held_axis_;  ///< when neither tilt nor azimuth changes
  std::optional<std::array<Profile, 3>> position_;
};

/// A recorded stroke played back: linear interpolation between the samples, held constant outside, the axis normalised
/// after interpolation.
class RecordedMotion final : public Motion {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 position = Vec3::Zero();
    Vec3 axis = {0.0, 0.0, -1.0};
  };

  /// Throws std::invalid_argument when there is no sample or times do not increase.
  explicit RecordedMotion(std::vector<Sample> samples);

  std::span<const Sample> samples() const { return samples_; }
  Vec3 axis_at(double t) const noexcept override;
  bool position_is_free() const noexcept override { return false; }
  Vec3 position_at(double t) const noexcept override;

 private:
  struct Leg {
    const Sample* from;
    const Sample* to;
    double fraction;
  };
  Leg leg_at(double t) const noexcept;

  std::vector<Sample> samples_;
};

}  // namespace hapbench
