#pragma once

#include <optional>

#include "sim/contact/contact_query.hpp"
#include "sim/geometry/springs.hpp"

namespace hapbench {

/// The springs scene of thesis A.2 as contacts of the tool's position: depth <p, u_j>, gradient u_j.
class SpringQuery final : public ContactQuery {
 public:
  explicit SpringQuery(SpringSet springs);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override;
  bool gives_depth() const noexcept override { return true; }
  std::unique_ptr<ContactQuery> with_margin(double margin) const override;
  void reset() noexcept override { work_ = {}; }

 private:
  void push(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient,
            ContactBuffer& contacts) const noexcept;

  SpringSet springs_;
  std::optional<double> margin_;  ///< of a query with one [m]
};

}  // namespace hapbench
