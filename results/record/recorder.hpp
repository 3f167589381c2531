#pragma once

#include <cstdint>

#include "results/io/io_error.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// An observer that writes one table, to a file or into memory. A file's rows are written during the run through a
/// buffer of fixed size; a run that is interrupted before `finish` leaves none.
class Recorder : public Observer {
 public:
  /// After the run: puts the file under its final name. Throws IoError, also for the errors of earlier rows.
  virtual void finish() = 0;
};

/// Returns true for the rows that a recorder keeps: the first one and every `every`-th after it. Precondition: every >
/// 0.
inline bool is_recorded(const StepRecord& record, std::uint64_t every) noexcept {
  return record.step % every == 0;
}

}  // namespace hapbench
