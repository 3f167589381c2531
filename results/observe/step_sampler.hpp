#pragma once

#include <cstdint>
#include <span>

#include "results/observe/step_times.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// What the steps of a run take by themselves, without the observers and recorders that watch them: samples of the time
/// from behind the last observer of a row to before the first one of the next. In between lie the integrator's half of
/// one step and the hand, search, law and device of the other. Attach `last` behind and `first` before all others.
///
/// Every step of a short run, at most kMostSamples of a long one, spread over it: enough for a 99th percentile and
/// less than a millisecond, as each takes two readings of the clock. Memory is allocated beforehand.
class StepSampler {
 public:
  static constexpr std::uint64_t kMostSamples = 1 << 13;

  /// `steps`: rows the run will have at most.
  explicit StepSampler(std::uint64_t steps);
  StepSampler(const StepSampler&) = delete;
  StepSampler& operator=(const StepSampler&) = delete;

  Observer& first() { return first_; }
  Observer& last() { return last_; }

  /// [ns], in their order, the clock's own share subtracted.
  std::span<const std::uint64_t> nanoseconds() const { return times_.nanoseconds(); }

 private:
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
  StepTimes times_;
  bool runs_ = false;
  First first_{*this};
  Last last_{*this};
};

}  // namespace hapbench
