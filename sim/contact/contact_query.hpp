#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
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

/// Finds the points of a shell that a tool in a given pose touches. Depths and gradients are left to a depth model.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;

  /// Replaces the contents of `contacts` by the colliding points (inside the tool or on its surface) in ascending
  /// index. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// Upper bound of the number of contacts of a query.
  virtual std::size_t capacity() const noexcept = 0;
  /// Returns to t = 0, counters included.
  virtual void reset() noexcept = 0;

  const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;
};

/// Compares every point of the shell with the tool, eight at a time: the reference for the faster searches
/// (neighbour_list_query.hpp), and fast enough for planar scenes. O(shell size), about 0.3 ns a point with 512-bit
/// registers.
class ShellQuery final : public ContactQuery {
 public:
  /// Shell and tool must outlive the query.
  ShellQuery(const PointShell& shell, const ToolShape& tool);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return shell_->size(); }
  void reset() noexcept override { work_ = {}; }

 private:
  const PointShell* shell_;
  const ToolShape* tool_;
  std::vector<std::uint8_t> marks_;
};

/// The search used by runs: neighbour lists, or brute force with Skips::off. Shell and tool must outlive it.
std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips);

}  // namespace hapbench
