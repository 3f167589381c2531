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

/// The contacts of another source, found in some rows only and used until newer ones come; none before the first.
///
/// Held contacts keep depth, point and gradient. Linear ones keep point and gradient, and their depth grows by the move
/// of the tool's material at x_i since the query at p_q, with Q = turn_matrix of the two poses:
///
///   d_i + <u_i, (p - p_q) + (Q - I)(x_i - p_q)>.
///
/// Those not above 0 are left out, except springs that pull. Integrators that ask within a step get the row's contacts,
/// held or moved to where they ask.
///
/// The source is asked when its answer comes due, for the pose of the query: queries on their way keep no contacts, and
/// sources with a memory still see them in order.
class LateContacts final : public ContactSource {
 public:
  /// `may_pull`: depths below 0 are springs that pull. Precondition: every >= 1, delay >= 0.
  LateContacts(std::unique_ptr<ContactSource> source, const Lateness& lateness, bool may_pull, std::uint64_t seed);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return source_->capacity(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return source_->work(); }

  const ContactSchedule* schedule() const noexcept override { return &schedule_; }

 private:
  /// Sends the query of the row, if it has one, and takes the answer that comes due.
  void begin_row(std::uint64_t row, const ToolPose& pose) noexcept;
  /// Replaces the contents of `contacts` by the found contacts with the depths that they have at this pose.
  void move_found_to(const ToolPose& pose, ContactBuffer& contacts) const noexcept;

  std::unique_ptr<ContactSource> source_;
  ContactSchedule schedule_;
  bool may_pull_;
  std::uint64_t seed_;
  Random random_;
  std::uint64_t calls_ = 0;                ///< rows so far of a source that no Simulation steps
  std::optional<std::uint64_t> last_row_;  ///< that has begun

  std::vector<ContactSchedule::Query> waiting_;  ///< ring of queries on their way
  std::size_t first_ = 0, count_ = 0;
  ContactBuffer found_;  ///< contacts of the query that serves
};

}  // namespace hapbench
