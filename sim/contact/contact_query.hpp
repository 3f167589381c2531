#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Counters of the work of a contact search since its last reset.
struct SearchWork {
  std::uint64_t queries = 0;
  std::uint64_t points_tested = 0;  ///< shell points compared with the tool, without padding
  std::uint64_t lists_rebuilt = 0;  ///< neighbour lists built; 0 for a search without lists
  /// Queries in which the tool is certainly too far away for a contact, so that no point is tested.
  std::uint64_t skipped = 0;

  SearchWork& operator+=(const SearchWork& other) noexcept {
    queries += other.queries;
    points_tested += other.points_tested;
    lists_rebuilt += other.lists_rebuilt;
    skipped += other.skipped;
    return *this;
  }
};

/// Finds the contacts of the tool in a given pose. A search (make_contact_query) finds points of a shell and
/// leaves their depths and gradients to a depth model.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;

  /// Replaces the contents of `contacts` by the contacts at the pose. A search returns the colliding points,
  /// which lie inside the tool or on its surface, in ascending index. Precondition: contacts.capacity() >=
  /// capacity(). Allocates nothing.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// Upper bound of the number of contacts at any pose.
  virtual std::size_t capacity() const noexcept = 0;
  /// Resets the state to t = 0 and all counters to zero.
  virtual void reset() noexcept { work_ = {}; }
  virtual const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;
};

/// Returns the contact search of a run. With Skips::on it uses neighbour lists. With Skips::off it compares
/// every point of the shell with the tool (brute force). Both searches return bitwise identical contacts. Shell
/// and tool must outlive the search. O(shell size).
std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips);

}  // namespace hapbench
