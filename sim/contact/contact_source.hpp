#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/random.hpp"
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

/// The environment as the step loop sees it: each contact comes with its depth and gradient, and the buffer is padded.
/// A shell of points needs a search and a depth model for that (algorithms/depth/depth_model.hpp); springs know their
/// depths, and so do modules (algorithms/module). Asked once in every step, and again within a step by some
/// integrators.
class ContactSource : public ContactQuery {
 public:
  /// Hands over the number of the present row, which changes before the first query of each row, to sources whose
  /// answer depends on more than the pose. Called once, before the first step, unless no Simulation steps the source.
  void follow(const std::uint64_t* row) { row_ = row; }
  /// Description of a failure in external code since the last reset, which ends the run; null if there was none. Not
  /// virtual, because every step reads it.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
  const std::uint64_t* row_ = nullptr;  ///< null where no Simulation counts rows
};

/// Springs attached to the tool's position, all with natural length at the origin (thesis A.2). Spring j has the unit
/// gradient u_j and the penetration depth d_j = <p, u_j>. Bilateral springs push and pull: their depths are signed, or,
/// following thesis 2.3 (d >= 0), |<p, u_j>| with the gradient along the displacement. The force is the same either
/// way, but a law that averages gradients takes opposite springs for one direction instead of none. Unilateral springs
/// are contacts only while d_j > 0.
struct SpringSet {
  std::vector<Vec3> gradients;
  bool bilateral = true;
  bool signed_depths = true;  ///< of bilateral springs
};

/// The springs as contacts of the tool's position.
class SpringSource final : public ContactSource {
 public:
  explicit SpringSource(std::shared_ptr<const SpringSet> springs) : springs_(std::move(springs)) {}

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_->gradients.size(); }

 private:
  std::shared_ptr<const SpringSet> springs_;
};

/// Appends the contact of one spring at the tool's position. Precondition: there is room.
void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient, ContactBuffer& contacts);

/// Contacts that were recorded at times: by a run, or by another engine. Contacts of one time stand together.
struct ContactTrace {
  struct Contact {
    Vec3 point;     ///< [m]
    Vec3 gradient;  ///< unit vector along which the tool gets deeper
    double depth;   ///< [m]
  };
  struct Time {
    double time;        ///< [s], ascending
    std::size_t first;  ///< its contacts are [first, first of the next time)
  };
  std::vector<Time> times;
  std::vector<Contact> contacts;

  /// The most contacts of one time.
  std::size_t most() const;
};

/// Gives each row the recorded contacts of the time nearest to its own, none when that is more than half a step away.
/// The pose has no part in it, so the motion is to be that of the recording. Index is the place among the contacts of
/// the time, the normal is the reversed gradient.
class TraceSource final : public ContactSource {
 public:
  TraceSource(std::shared_ptr<const ContactTrace> trace, double dt);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return capacity_; }

 private:
  std::shared_ptr<const ContactTrace> trace_;
  double dt_;
  std::size_t capacity_;
};

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
  struct Query {
    ToolPose pose;
    std::uint64_t row = 0;
  };

  /// `may_pull`: depths below 0 are springs that pull. Precondition: every >= 1, delay >= 0.
  LateContacts(std::unique_ptr<ContactSource> source, const Lateness& lateness, bool may_pull, std::uint64_t seed);

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return source_->capacity(); }
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
