#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

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

 private:
  std::shared_ptr<const SpringSet> springs_;
};

/// Appends the contact of one spring at the tool's position. Precondition: there is room.
void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient, ContactBuffer& contacts);

}  // namespace hapbench
