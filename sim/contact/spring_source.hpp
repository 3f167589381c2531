#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Springs that act on the tool (thesis section A.2). At the origin all springs have their rest length. With the tool
/// at the position p, spring j has the unit gradient u_j and the depth d_j = <p, u_j> [m].
///
/// Bilateral springs push and pull. With signed_depths, the depth of a bilateral spring is d_j and may be negative.
/// Without signed_depths, the depth is |d_j| >= 0, as in section 2.3 of the thesis, and the gradient is -u_j if
/// d_j < 0. The force of a spring is the same in both cases. A law that averages gradients distinguishes the cases:
/// with signed depths, the gradients of opposite springs cancel; without signed depths, they are equal. Unilateral
/// springs are contacts only while d_j > 0.
struct SpringSet {
  /// Unit vectors u_j.
  std::vector<Vec3> gradients;
  bool bilateral = true;
  bool signed_depths = true;  ///< false: depths are |<p, u_j>|; used for bilateral springs only
};

/// Contact source of a spring set: each spring is a contact at the tool's position.
class SpringSource final : public ContactSource {
 public:
  explicit SpringSource(std::shared_ptr<const SpringSet> springs) : springs_(std::move(springs)) {}

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_->gradients.size(); }

 private:
  std::shared_ptr<const SpringSet> springs_;
};

/// Appends one spring as a contact at the tool's position [m], with its depth [m] and unit gradient.
/// Precondition: contacts.size() < contacts.capacity().
void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient, ContactBuffer& contacts);

}  // namespace hapbench
