#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

/// What the reduction does to the force. It keeps some of the contacts; as the tool slides, others take their place,
/// and the force jumps with them.
struct ReductionJumps {
  std::uint64_t changes = 0;               ///< rows whose set of kept points is another than the row before's
  std::optional<double> step_max_squared;  ///< largest squared force step of such rows in settled contact [N^2]
  /// Of the other rows in settled contact [N^2], but for those right after a change: a jump of the force is a jump of
  /// the velocity one row later, which the damping answers.
  double step_max_squared_elsewhere = 0.0;

  ReductionJumps& operator+=(const ReductionJumps& other) noexcept;
  std::optional<double> step_max() const noexcept;  ///< [N]
  double step_max_elsewhere() const noexcept;       ///< [N]
  /// True when the force steps far more where the points change than it does elsewhere: by more than a factor of 3.
  bool stand_out() const noexcept;
};

/// Watches which points a law sees from row to row. Allocates in the constructor only; a comparison of the points'
/// numbers a row, about 1 ns a point.
class ReductionJumpObserver {
 public:
  /// `capacity`: the most contacts a row can have.
  explicit ReductionJumpObserver(std::size_t capacity) { last_.reserve(capacity); }

  /// The next row: the contacts that the reduction kept, its squared force step, whether it is one of settled contact.
  void add(const ContactBuffer& kept, double step_squared, bool settled) noexcept;

  const ReductionJumps& jumps() const noexcept { return jumps_; }

 private:
  std::vector<std::uint32_t> last_;  ///< numbers of the points of the row before
  bool changed_ = false;             ///< they were others than those before
  ReductionJumps jumps_;
};

}  // namespace hapbench
