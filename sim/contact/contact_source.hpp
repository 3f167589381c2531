#pragma once

#include <cstdint>

#include "sim/contact/contact_query.hpp"

namespace hapbench {

struct ContactSchedule;

/// The environment as the step loop sees it: each contact comes with its depth and gradient, and the buffer is padded.
/// A shell of points needs a search and a depth model for that (algorithms/depth/depth_model.hpp); springs know their
/// depths, and so do modules (algorithms/module). Asked once in every step, and again within a step by some
/// integrators.
class ContactSource : public ContactQuery {
 public:
  /// Hands over the number of the present row, which changes before the first query of each row, to sources whose
  /// answer depends on more than the pose. Called once, before the first step, unless no Simulation steps the source.
  void follow(const std::uint64_t* row) { row_ = row; }
  /// The rows in which the source finds contacts; null if it finds them in every row. The pointer stays valid as long
  /// as the source. Called before the first step, never within a step.
  virtual const ContactSchedule* schedule() const noexcept { return nullptr; }
  /// Description of a failure in external code since the last reset, which ends the run; null if there was none. Not
  /// virtual, because every step reads it.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
  const std::uint64_t* row_ = nullptr;  ///< null where no Simulation counts rows
};

}  // namespace hapbench
