#pragma once

#include <memory>

#include "sim/contact/contact_source.hpp"
#include "sim/geometry/springs.hpp"

namespace hapbench {

/// The springs scene of thesis A.2 as contacts of the tool's position, with the depths and gradients of SpringSet.
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
