#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/loop/observer.hpp"

namespace hapbench {

/// What the steps of a run take by themselves, without the observers and recorders that watch them: samples of the time
/// from behind the last observer of a row to before the first one of the next. In between lie the integrator's half of
/// one step and the hand, search, law and device of the other. Attach `last` behind and `first` before all others.
///
/// At most kMostSamples, spread over the run, in memory that is allocated beforehand; two readings of the clock each.
class StepSampler {
 public:
  static constexpr std::uint64_t kMostSamples = 1 << 15;

  /// `steps`: rows the run will have at most.
  explicit StepSampler(std::uint64_t steps);
  StepSampler(const StepSampler&) = delete;
  StepSampler& operator=(const StepSampler&) = delete;

  Observer& first() { return first_; }
  Observer& last() { return last_; }

  /// [ns], in their order, the clock's own share subtracted; 4.29 s for longer ones.
  std::span<const std::uint32_t> nanoseconds() const { return samples_; }

 private:
  using Clock = std::chrono::steady_clock;

  class First final : public Observer {
   public:
    explicit First(StepSampler& sampler) : sampler_(sampler) {}
    void on_step(const StepRecord&) noexcept override { sampler_.stop(); }

   private:
    StepSampler& sampler_;
  };
  class Last final : public Observer {
   public:
    explicit Last(StepSampler& sampler) : sampler_(sampler) {}
    void on_step(const StepRecord& record) noexcept override { sampler_.start(record.step); }

   private:
    StepSampler& sampler_;
  };

  void start(std::uint64_t step) noexcept;
  void stop() noexcept;

  std::uint64_t every_;
  std::int64_t overhead_ = 0;  ///< [ns]
  bool runs_ = false;
  Clock::time_point start_;
  std::vector<std::uint32_t> samples_;
  First first_{*this};
  Last last_{*this};
};

}  // namespace hapbench
