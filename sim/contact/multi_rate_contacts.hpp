#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_schedule.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

/// Multi-rate contacts: the contacts of another source, found in some steps only and used until newer contacts
/// arrive. There are no contacts before the first query has returned.
///
/// Held contacts keep depth, point and gradient. With MultiRateSchedule::linear, contacts are moved instead: contact i
/// keeps its point x_i and its gradient u_i. Its depth changes from d_i at the query with the motion of the tool's
/// material at x_i to
///
///   d_i + <u_i, (p - p_q) + (Q - I)(x_i - p_q)>
///
/// with the tip centre p of the current pose, the tip centre p_q of the query's pose, the identity I, and Q =
/// turn_matrix of the two poses. Moved contacts with a depth <= 0 are dropped, except for springs that may pull. An
/// integrator that queries again within a step gets the contacts of the step, held or moved to the pose of the new
/// query.
///
/// A query first stores only its pose. The other source computes the contacts for this pose in the step in which they
/// are due. Pending queries therefore store no contacts, and a source with internal state still gets all queries in
/// order.
class MultiRateContacts final : public ContactSource {
 public:
  /// `may_pull`: true if contacts with negative depth are springs that pull, so that they are kept. `seed` determines
  /// which queries are lost. Precondition: every >= 1, delay >= 0.
  MultiRateContacts(std::unique_ptr<ContactSource> source, const MultiRateSchedule& timing, bool may_pull,
                    std::uint64_t seed);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return source_->capacity(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return source_->work(); }

  const ContactSchedule* schedule() const noexcept override { return &schedule_; }

 private:
  /// Sends a query if a query is scheduled in this step. Then takes the result of a query if this result is due.
  void begin_step(std::uint64_t row, const ToolPose& pose) noexcept;
  /// Replaces the contents of `contacts` by the found contacts, with their depths extrapolated linearly to this
  /// pose.
  void move_found_to(const ToolPose& pose, ContactBuffer& contacts) const noexcept;

  std::unique_ptr<ContactSource> source_;
  ContactSchedule schedule_;
  bool may_pull_;
  std::uint64_t seed_;
  Random random_;
  std::uint64_t calls_ = 0;                 ///< number of calls so far: the step number if follow() was not called
  std::optional<std::uint64_t> last_step_;  ///< last step that has begun; empty before the first step

  std::vector<ContactSchedule::Query> waiting_;  ///< ring buffer of pending queries
  std::size_t first_ = 0, count_ = 0;
  ContactBuffer found_;  ///< contacts of the query in use
};

}  // namespace hapbench
