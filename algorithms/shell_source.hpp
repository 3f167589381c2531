#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench {

/// The points of a shell as contacts: a search finds them, a depth model gives them depth and gradient. Steps that
/// follow a step without contacts and have none either pass over the depth model (Skips).
class ShellSource final : public ContactSource {
 public:
  /// Shell and tool must outlive the source, and so must they the search, which is over them.
  ShellSource(const PointShell& shell, const ToolShape& tool, std::unique_ptr<ContactQuery> search,
              std::unique_ptr<DepthModel> depth_model, Skips skips = Skips::on);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return search_->capacity(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return search_->work(); }

 private:
  const ToolShape* tool_;
  std::unique_ptr<ContactQuery> search_;
  std::unique_ptr<DepthModel> depth_model_;
  Skips skips_;
  bool knows_of_no_contacts_ = false;  ///< the depth model: it was told in the last step, or some steps before
};

}  // namespace hapbench
