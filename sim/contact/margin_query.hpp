#pragma once

#include <memory>

#include "sim/contact/contact_query.hpp"

namespace hapbench {

/// The tool grown by `margin` [m] on all sides. A flat one reaches further beyond its tip plane, so its tip centre lies
/// `margin` ahead along the axis (see MarginQuery). Not rounded: at a flat tool's edges it reaches sqrt(2) margin.
Tool grown(const Tool& tool, double margin) noexcept;

/// What lies in or near the tool: a query with the grown tool in its place.
class MarginQuery final : public ContactQuery {
 public:
  /// `query` has the tool grown by `margin`.
  MarginQuery(std::unique_ptr<ContactQuery> query, const Tool& tool, double margin);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return query_->capacity(); }
  bool gives_depth() const noexcept override { return query_->gives_depth(); }
  std::unique_ptr<ContactQuery> with_margin(double margin) const override;
  void reset() noexcept override;

 private:
  MarginQuery(std::unique_ptr<ContactQuery> query, double forward);

  std::unique_ptr<ContactQuery> query_;
  double forward_;  ///< of the grown tool's tip centre along the axis [m]
};

}  // namespace hapbench
