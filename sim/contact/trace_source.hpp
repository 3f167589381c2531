#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Contacts that were recorded at times: by a run, or by another engine. Contacts of one time stand together.
struct ContactTrace {
  struct Contact {
    Vec3 point;     ///< [m]
    Vec3 gradient;  ///< unit vector along which the tool gets deeper
    double depth;   ///< [m]
  };
  struct Time {
    double time;        ///< [s], ascending
    std::size_t first;  ///< its contacts are [first, first of the next time)
  };
  std::vector<Time> times;
  std::vector<Contact> contacts;

  /// One past the last contact of times[i].
  std::size_t end_of(std::size_t i) const;
  /// The most contacts of one time.
  std::size_t most() const;
};

/// Gives each row the recorded contacts of the time nearest to its own, none when that is more than half a step away.
/// The pose has no part in it, so the motion is to be that of the recording. Index is the place among the contacts of
/// the time, the normal is the reversed gradient.
class TraceSource final : public ContactSource {
 public:
  TraceSource(std::shared_ptr<const ContactTrace> trace, double dt);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }

 private:
  std::shared_ptr<const ContactTrace> trace_;
  double dt_;
  std::size_t capacity_;
};

}  // namespace hapbench
