#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Notes when the tool touches an open mesh where it ends. Beyond such an edge there is nothing to touch, and a tool
/// that reaches past it is held by too few points or by none.
class OpenEdgeObserver final : public Observer {
 public:
  /// A point of the shell counts as near an edge if it lies within `reach` [m] of one of `edges`, the middles of the
  /// boundary edges, along each coordinate. O(n) and the points near edges.
  OpenEdgeObserver(const PointShell& shell, const std::vector<Vec3>& edges, double reach);

  void on_step(const StepRecord& record) noexcept override;

  /// What a reader of the results must know; none when no such point was touched.
  std::optional<std::string> warning() const;

 private:
  double reach_;
  std::vector<bool> is_near_edge_;  ///< of each point of the shell
  std::uint64_t rows_ = 0;          ///< with such a contact
  double first_time_ = 0.0;         ///< [s]
  Vec3 first_place_ = Vec3::Zero();
};

}  // namespace hapbench
