#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Work done by a contact search since its last reset.
struct SearchWork {
  std::uint64_t queries = 0;
  std::uint64_t points_tested = 0;  ///< shell points compared with the tool, without padding
  std::uint64_t lists_rebuilt = 0;  ///< neighbour lists; 0 for a search without them
  std::uint64_t skipped = 0;        ///< queries answered "nothing" from a clearance bound, without testing a point

  SearchWork& operator+=(const SearchWork& other) noexcept {
    queries += other.queries;
    points_tested += other.points_tested;
    lists_rebuilt += other.lists_rebuilt;
    skipped += other.skipped;
    return *this;
  }
};

/// Finds the contacts that a tool in a given pose has. Of a search (make_contact_query) they are points of a shell,
/// whose depths and gradients are left to a depth model.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;

  /// Replaces the contents of `contacts` by the contacts at the pose: of a search the colliding points (inside the tool
  /// or on its surface) in ascending index. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// Upper bound of the number of contacts at a pose.
  virtual std::size_t capacity() const noexcept = 0;
  /// Returns to t = 0, counters included.
  virtual void reset() noexcept { work_ = {}; }
  virtual const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;
};

/// The search used by runs: neighbour lists, or with Skips::off brute force, which compares every point of the shell
/// with the tool. Their answers are the same bit by bit. Shell and tool must outlive it. O(shell size).
std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips);

}  // namespace hapbench
