#pragma once

#include "sim/contact/contact_query.hpp"
#include "sim/environment/springs.hpp"

namespace hapbench {

/// The springs scene of thesis A.2 as contacts of the tool's position: depth <p, u_j>, gradient u_j.
class SpringQuery final : public ContactQuery {
 public:
  explicit SpringQuery(SpringSet springs);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_.gradients.size(); }
  bool gives_depth() const noexcept override { return true; }
  void reset() noexcept override { work_ = {}; }

 private:
  SpringSet springs_;
};

}  // namespace hapbench
