#pragma once

#include <cstdint>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// What a contact query has done since its last reset.
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

/// Answers which points of the environment a tool in a given pose touches. The step loop asks at the tool's pose; a
/// force algorithm that keeps a proxy may ask again at a pose of its choosing.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;

  /// Replaces the contents of `contacts` by the colliding points (inside the tool or on its surface) in ascending
  /// index. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// The most contacts a query can return.
  virtual std::size_t capacity() const noexcept = 0;
  /// True when the query itself fills depth and gradient (springs), so that no depth model applies.
  virtual bool gives_depth() const noexcept = 0;
  /// A query of its own over the same environment that answers with what lies within `margin` >= 0 [m] of the tool's
  /// surface as well (and with some points a little further away, at a flat tool's edges). Springs answer those that
  /// the tool could compress by moving that far; a bilateral spring holds the tool from both sides, so it is answered
  /// twice, as the pair (d, u) and (-d, -u). Allocates; the environment must outlive it.
  virtual std::unique_ptr<ContactQuery> with_margin(double margin) const = 0;
  /// Back to t = 0, counters included.
  virtual void reset() noexcept = 0;

  const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;
};

}  // namespace hapbench
