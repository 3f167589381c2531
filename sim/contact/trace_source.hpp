#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Recorded contacts, from a run of hapbench or from another program, sorted by time. The contacts of one time are
/// contiguous.
struct ContactTrace {
  struct Contact {
    Vec3 point;     ///< colliding point, world frame [m]
    Vec3 gradient;  ///< unit vector along which the tool gets deeper
    double depth;   ///< penetration depth [m]
  };
  struct Time {
    double time;        ///< [s], ascending from entry to entry
    std::size_t first;  ///< index of the first contact at this time; the contacts end before `first` of the next entry
  };
  std::vector<Time> times;
  std::vector<Contact> contacts;

  /// Returns the index one past the last contact of times[i].
  std::size_t end_of(std::size_t i) const;
  /// Returns the largest number of contacts at one time.
  std::size_t max_contacts() const;
};

/// Largest distance of the times of a trace and of a step that has its contacts, in time steps: half a step, and a
/// tolerance for the rounding of recorded times, which may all lie in the middle between two steps.
inline constexpr double kTraceWindow = 0.5 * (1.0 + 1e-6);

/// Plays back a contact trace. A step gets the contacts recorded nearest to its time, or none if the nearest
/// time is more than half a step away. The pose has no effect, so the tool should move as in the recording. A
/// contact's index is its number, from 0, among the contacts recorded at the same time. Its normal is the reversed
/// gradient.
class TraceSource final : public ContactSource {
 public:
  /// `dt`: time step of the run [s].
  TraceSource(std::shared_ptr<const ContactTrace> trace, double dt);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }

 private:
  std::shared_ptr<const ContactTrace> trace_;
  double dt_;
  std::size_t capacity_;
};

}  // namespace hapbench
