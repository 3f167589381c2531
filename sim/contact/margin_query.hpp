#pragma once

#include <memory>
#include <utility>

#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// What lies in or near the tool: a query with the grown tool in its place.
class MarginQuery final : public ContactQuery {
 public:
  /// `query` searches with the shape of `tool`, which it may need to be kept alive.
  MarginQuery(ToolShape::Grown tool, std::unique_ptr<ContactQuery> query);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return query_->capacity(); }
  bool gives_depth() const noexcept override { return query_->gives_depth(); }
  std::unique_ptr<ContactQuery> with_margin(double margin) const override;
  void reset() noexcept override;

 private:
  ToolShape::Grown tool_;
  std::unique_ptr<ContactQuery> query_;
};

/// A Query over the shell that answers with what lies in or near the tool.
template <class Query>
std::unique_ptr<ContactQuery> make_margin_query(const PointShell& shell, const ToolShape& tool, double margin) {
  ToolShape::Grown grown = tool.grown(margin);
  auto query = std::make_unique<Query>(shell, *grown.shape);
  return std::make_unique<MarginQuery>(std::move(grown), std::move(query));
}

}  // namespace hapbench
