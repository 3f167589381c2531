#pragma once

#include "sim/contact/contact_query.hpp"

namespace hapbench {

/// The environment as the step loop sees it: answers which contacts a tool in a given pose has, each with its depth and
/// gradient. A shell of points needs a search and a depth model for that (algorithms/depth/depth_model.hpp); springs know
/// their depths, and so do other libraries (algorithms/peers).
class ContactSource {
 public:
  virtual ~ContactSource() = default;

  /// Replaces the contents of `contacts` by the contacts at the pose, padded. Precondition: contacts.capacity() >=
  /// capacity(). Allocates nothing. Called once in every step, and again within a step by integrators that ask.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// The most contacts an answer can have.
  virtual std::size_t capacity() const noexcept = 0;
  /// Back to t = 0, counters included.
  virtual void reset() noexcept = 0;
  virtual const SearchWork& work() const noexcept = 0;
  /// What went wrong in code from outside since the last reset, which ends the run; null for nothing. Not virtual: it
  /// is looked at in every step.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
};

}  // namespace hapbench
