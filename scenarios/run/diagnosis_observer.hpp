#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "results/observe/contact_forces.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// What rules need of the rows of a run, of all its trials; the last quarter is the one in which the last trial ended.
struct SeenRows {
  std::uint64_t touching = 0;        ///< rows in contact; of these
  std::uint64_t at_force_limit = 0;  ///< with the largest force of device or rendering
  std::uint64_t at_limiter = 0;      ///< with as much hand force as the device's limiter lets in
  double way_in_contact = 0.0;       ///< of the tip [m]
  double longest_step = 0.0;         ///< OutcomeObserver::longest_step [m]
  Vec3 last_force = Vec3::Zero();    ///< rendered [N]
  struct Quarter {
    std::uint64_t rows = 0;
    bool touches = true;                        ///< in all of them
    Vec3 start = Vec3::Zero();                  ///< of the tip [m]
    Vec3 high_squares = Vec3::Zero();           ///< sum of the squares of the force above 30 Hz [N^2]
    std::array<std::uint64_t, 3> high_turns{};  ///< its changes of sign
  } last_quarter;
  Vec3 tip = Vec3::Zero();  ///< in the last row [m]
};

/// Watches a run for the rules; some 20 ns a row, in constant memory.
class DiagnosisObserver final : public Observer {
 public:
  /// The scenario must outlive the observer.
  explicit DiagnosisObserver(const Scenario& scenario);

  void on_step(const StepRecord& record) noexcept override;

  /// After a trial: its OutcomeObserver::longest_step [m].
  void add_longest_step(double way) noexcept { seen_.longest_step = std::max(seen_.longest_step, way); }

  const SeenRows& rows() const noexcept { return seen_; }

 private:
  void add_contact(const StepRecord& record) noexcept;
  void add_to_quarter(const StepRecord& record) noexcept;

  const Scenario& scenario_;
  std::optional<double> force_limit_, input_limit_;  ///< [N]
  std::optional<HighPass> high_pass_;
  std::uint64_t quarter_ = 0;
  bool touched_ = false;      ///< in the row before
  Vec3 high_ = Vec3::Zero();  ///< force above 30 Hz in the row before [N]
  SeenRows seen_;
};

}  // namespace hapbench
