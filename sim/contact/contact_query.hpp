#pragma once

#include <cstdint>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/skips.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// What a contact search has done since its last reset.
struct SearchWork {
  std::uint64_t queries = 0;
  std::uint64_t points_tested = 0;  ///< shell points compared with the tool, padding not counted
  std::uint64_t lists_rebuilt = 0;  ///< neighbour lists; 0 for a search without one
  std::uint64_t skipped = 0;        ///< queries answered "nothing" from a clearance bound, without testing a point

  SearchWork& operator+=(const SearchWork& other) noexcept {
    queries += other.queries;
    points_tested += other.points_tested;
    lists_rebuilt += other.lists_rebuilt;
    skipped += other.skipped;
    return *this;
  }
};

/// Answers which points of a shell a tool in a given pose touches. Depths and gradients are left to a depth model.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;

  /// Replaces the contents of `contacts` by the colliding points (inside the tool or on its surface) in ascending
  /// index. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// The most contacts a query can return.
  virtual std::size_t capacity() const noexcept = 0;
  /// Back to t = 0, counters included.
  virtual void reset() noexcept = 0;

  const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;
};

/// The search that runs use: neighbour lists, or brute force with skips off. Shell and tool must outlive it.
std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips);

}  // namespace hapbench
