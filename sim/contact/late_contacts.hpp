#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

/// How late contacts come: a slow loop finds them while a fast one renders (multi-rate rendering).
struct Lateness {
  std::int64_t every = 1;  ///< contacts are found at rows 0, every, 2 every, …
  std::int64_t delay = 0;  ///< rows from a query until its contacts serve
  bool linear = false;     ///< depths follow the tool until the next answer; else they are held
  double dropout = 0.0;    ///< probability that a query after the first is lost

  /// False where every row has its own contacts.
  bool any() const { return every > 1 || delay > 0 || dropout > 0.0; }
};

/// The contacts of another source, found in some rows only and used until newer ones come; none before the first.
///
/// Held contacts keep depth, point and gradient. Linear ones keep point and gradient, and their depth is
///
///   d_i + <u_i, (p - p_q) + (Q - I)(x_i - p_q)>,
///
/// what the tool's material at x_i has moved by since the query at p_q, with Q = turn_matrix of the two poses. Those
/// whose depth is then not above 0 are left out, except springs that pull. Integrators that ask within a step get the
/// row's contacts, held or moved to where they ask.
///
/// The source is asked when its answer comes due, for the pose of the query. So no contacts are kept of
/// queries on their way, and sources with a memory still see the queries in order.
class LateContacts final : public ContactSource {
 public:
  struct Query {
    ToolPose pose;
    std::uint64_t row = 0;
  };

  /// `may_pull`: depths below 0 are springs that pull. Precondition: every >= 1, delay >= 0.
  LateContacts(std::unique_ptr<ContactSource> source, const Lateness& lateness, bool may_pull, std::uint64_t seed);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return source_->capacity(); }
  void follow(const std::uint64_t* row) override { row_ = row; }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return source_->work(); }

  const Lateness& lateness() const { return lateness_; }
  /// The query whose contacts serve in the present row; null before the first.
  const Query* used() const { return serves_ ? &used_ : nullptr; }
  std::uint64_t asked() const { return asked_; }  ///< queries, those that were lost included
  std::uint64_t lost() const { return lost_; }

 private:
  void begin_row(std::uint64_t row, const ToolPose& pose) noexcept;

  std::unique_ptr<ContactSource> source_;
  Lateness lateness_;
  bool may_pull_;
  std::uint64_t seed_;
  Random random_;
  const std::uint64_t* row_ = nullptr;
  std::uint64_t calls_ = 0;                ///< rows so far of a source that no Simulation steps
  std::optional<std::uint64_t> last_row_;  ///< that has begun

  std::vector<Query> waiting_;  ///< ring of queries on their way
  std::size_t first_ = 0, count_ = 0;
  bool serves_ = false;
  Query used_;
  ContactBuffer found_;  ///< contacts of `used_`
  std::uint64_t asked_ = 0, lost_ = 0;
};

}  // namespace hapbench
