#pragma once

#include <cstdint>
#include <memory>
#include <utility>
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
  virtual void reset() noexcept { work_ = {}; }

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

 private:
  const PointShell* shell_;
  const ToolShape* tool_;
  std::vector<std::uint8_t> marks_;
};

/// The search used by runs: neighbour lists, or brute force with Skips::off. Shell and tool must outlive it.
std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips);

/// The environment as the step loop sees it: answers which contacts a tool in a given pose has, each with its depth and
/// gradient. A shell of points needs a search and a depth model for that (algorithms/depth/depth_model.hpp); springs
/// know their depths, and so do modules (algorithms/module).
class ContactSource {
 public:
  virtual ~ContactSource() = default;

  /// Replaces the contents of `contacts` by the contacts at the pose, padded. Precondition: contacts.capacity() >=
  /// capacity(). Allocates nothing. Called once in every step, and again within a step by some integrators.
  virtual void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept = 0;
  /// Upper bound of the number of contacts at a pose.
  virtual std::size_t capacity() const noexcept = 0;
  /// Hands over the number of the present row, which changes before the first query of each row, to sources whose
  /// answer depends on more than the pose. Called once, before the first step, unless no Simulation steps the source.
  virtual void follow(const std::uint64_t* /*row*/) {}
  /// Returns to t = 0, counters included.
  virtual void reset() noexcept { work_ = {}; }
  virtual const SearchWork& work() const noexcept { return work_; }
  /// Description of a failure in external code since the last reset, which ends the run; null if there was none. Not
  /// virtual, because every step reads it.
  const char* fault() const noexcept { return fault_; }

 protected:
  const char* fault_ = nullptr;
  SearchWork work_;  ///< of a source that has no search
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
  void follow(const std::uint64_t* row) override { row_ = row; }

 private:
  std::shared_ptr<const ContactTrace> trace_;
  double dt_;
  std::size_t capacity_;
  const std::uint64_t* row_ = nullptr;  ///< null where no Simulation counts rows; then the queries do
};

}  // namespace hapbench
