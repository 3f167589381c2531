#pragma once

#include <cstdint>

#include "sim/contact/contact_query.hpp"

namespace hapbench {

struct ContactSchedule;

/// Interface through which the step loop queries the environment. A query returns contacts with depth and gradient, in
/// a padded buffer. For a shell of points, a search and a depth model compute these contacts (ShellSource in
/// algorithms/depth/depth_model.hpp). Springs and modules (algorithms/module) compute their depths themselves. The
/// source is queried once in every step, and again within a step by integrators that evaluate the force more than once.
class ContactSource : public ContactQuery {
 public:
  /// Gives the source access to the number of the current step, for sources whose contacts depend on more than the
  /// pose. `*row` changes before the first query of each step. Called once, before the first step. Not called if
  /// neither a Simulation nor a LiveLoop runs the source.
  void follow(const std::uint64_t* row) { row_ = row; }
  /// Returns the schedule of a source that does not find contacts in every step; null if it finds them in every
  /// step. The pointer is valid as long as the source exists. Called before the first step only.
  virtual const ContactSchedule* schedule() const noexcept { return nullptr; }
  /// Returns a description of a failure in external code since the last reset, or null. A failure ends the run.
  /// Not virtual, because every step reads it.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
  const std::uint64_t* row_ = nullptr;  ///< number of the current step; null if follow() was not called
};

}  // namespace hapbench
