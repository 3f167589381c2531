#pragma once

#include <memory>
#include <vector>

#include "sim/contact/contact_source.hpp"

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
  void follow(const std::uint64_t* row) override { row_ = row; }
  void reset() noexcept override { work_ = {}; }
  const SearchWork& work() const noexcept override { return work_; }

 private:
  std::shared_ptr<const ContactTrace> trace_;
  double dt_;
  std::size_t capacity_;
  const std::uint64_t* row_ = nullptr;
  SearchWork work_;  ///< its queries count the rows where no Simulation does
};

}  // namespace hapbench
