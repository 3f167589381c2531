#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "sim/contact/contact_query.hpp"

namespace hapbench {

/// The environment as the step loop sees it: answers which contacts a tool in a given pose has, each with its depth and
/// gradient. A shell of points needs a search and a depth model for that (algorithms/depth/depth_model.hpp); springs
/// know their depths, and so do other libraries (algorithms/peers).
class ContactSource {
 public:
  virtual ~ContactSource() = default;

  /// Replaces the contents of `contacts` by the contacts at the pose, padded. Precondition: contacts.capacity() >=
  /// capacity(). Allocates nothing. Called once in every step, and again within a step by some integrators.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// Upper bound of the number of contacts at a pose.
  virtual std::size_t capacity() const noexcept = 0;
  /// Hands over the number of the present row, which changes before the first query of each row, to sources whose
  /// answer depends on more than the pose. Called once, before the first step, unless no Simulation steps the source.
  virtual void follow(const std::uint64_t* row) { static_cast<void>(row); }
  /// Returns to t = 0, counters included.
  virtual void reset() noexcept = 0;
  virtual const SearchWork& work() const noexcept = 0;
  /// Description of a failure in external code since the last reset, which ends the run; null if there was none. Not
  /// virtual, because every step reads it.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
};

/// Springs attached to the tool's position, all with natural length at the origin (thesis A.2). Spring j has the unit
/// gradient u_j and the penetration depth d_j = <p, u_j>. Bilateral springs push and pull: their depths are signed, or,
/// following thesis 2.3 (d >= 0), |<p, u_j>| with the gradient along the displacement. The force is the same either
/// way, but a law that averages gradients takes opposite springs for one direction instead of none. Unilateral springs
/// are contacts only while d_j > 0.
struct SpringSet {
  std::vector<Vec3> gradients;
  bool bilateral = true;
  bool signed_depths = true;  ///< of bilateral springs
};

/// The springs as contacts of the tool's position.
class SpringSource final : public ContactSource {
 public:
  explicit SpringSource(std::shared_ptr<const SpringSet> springs) : springs_(std::move(springs)) {}

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_->gradients.size(); }
  void reset() noexcept override { work_ = {}; }
  const SearchWork& work() const noexcept override { return work_; }

 private:
  std::shared_ptr<const SpringSet> springs_;
  SearchWork work_;
};

/// Appends the contact of one spring at the tool's position. Precondition: there is room.
void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient, ContactBuffer& contacts);

}  // namespace hapbench
