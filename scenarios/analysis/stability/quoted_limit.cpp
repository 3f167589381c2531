#include "scenarios/analysis/stability/quoted_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/analysis/stability/limit_theory.hpp"

namespace hapbench {
namespace {

std::string number(double value) {
  return fmt::format("{:.6g}", value);
}

/// Returns a clause with the measured property of the run at the simulated limit that may explain why the run is stable
/// beyond the linear limit.
std::string measured_cause(const LimitQuestion& question, const FieldLimit& limit) {
  const SettledState& settled = limit.settled;
  const std::string run = fmt::format("the run at {}", number(*limit.end.value));
  if (settled.is_held && settled.touches) return run + " rests in contact, where dry friction acts on it";
  if (settled.rests && settled.touches) return run + " comes to rest in contact";
  if (settled.share_away > 0.0)
    return fmt::format("{} is out of contact in {:.2g} % of its last quarter", run, 100.0 * settled.share_away);
  if (question.rule.max_vibration && settled.vibration.value_or(0.0) > 0.0)
    return fmt::format("{} vibrates by {:.2g} m/s rms, below the allowed {:.2g}", run, *settled.vibration,
                       *question.rule.max_vibration);
  if (settled.contacts_change) return run + " gains and loses contact points in its last quarter";
  return run + " shows no growth in its duration";
}

/// Returns a clause with the number of stable runs beyond the unstable run next to the simulated limit; empty if there
/// are no such runs.
std::string stable_beyond(const LimitQuestion& question, const FieldLimit& limit) {
  const auto is_beyond = [&](const JudgedValue& run) {
    const double next = limit.end.beyond->value;
    return question.search.smallest ? run.value < next : run.value > next;
  };
  const auto is_stable_beyond = [&](const JudgedValue& run) {
    return is_beyond(run) && question.rule.holds(run.verdict);
  };
  const auto stable = std::ranges::count_if(limit.runs, is_stable_beyond);
  if (stable == 0) return "";
  return fmt::format("; {} of {} runs beyond it are stable", stable, std::ranges::count_if(limit.runs, is_beyond));
}

/// Returns a clause about the unstable run next to the simulated limit.
std::string next_run(const LimitQuestion& question, const FieldLimit& limit) {
  const auto& [value, verdict] = *limit.end.beyond;
  const char* const fades =
      limit.beyond_fades ? " (its amplitude falls, but slowly: with a longer time.duration_s it may be stable)" : "";
  return fmt::format("the run at {} is {}{}{}", number(value), run_verdict_name(verdict), fades,
                     stable_beyond(question, limit));
}

/// Returns the reason why there is no linear limit within the range.
std::string without_linear(const FieldLimit& limit) {
  if (!limit.no_linear.empty()) return fmt::format("there is no linear limit: {}", limit.no_linear);
  const auto& linear = limit.known_linear_limit();
  if (linear && (std::isinf(*linear) || *linear == 0.0)) return "the linear loop is stable to the end of the range";
  return "no linear limit applies";
}

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the cases in the order of their priority.
QuotedLimit quoted_limit(const LimitQuestion& question, const FieldLimit& limit) {
  const bool smallest = question.search.smallest;
  // Words for the direction from stable to unstable values, and for the opposite direction.
  const char *const to = smallest ? "down to" : "up to", *const from = smallest ? "up to" : "down to";
  const auto& [value, beyond] = limit.end;
  if (limit.theory_has_none) return {{}, "by the eigenvalues of one step, no value of the range is stable"};
  if (!value) return {{}, "no interval of values is stable"};
  if (limit.violates_with_errors)
    return {{},
            "a bounded metric with its error added violates its bound, even after four searches with tighter bounds"};
  // Returns true if the field reaches the value a before the value b on its way from stable to unstable values.
  const auto is_first = [smallest](double a, double b) { return smallest ? a > b : a < b; };
  const auto& linear = limit.known_linear_limit();
  if (limit.linear == limit_without_transition(false, smallest))
    return {{}, "by the eigenvalues of the loop in contact, no value of the range is stable"};
  const bool has_linear = linear && std::isfinite(*linear) && *linear > 0.0;
  const std::string name = limit.theory ? "theoretical limit (eigenvalues, contact cannot be lost)"
                                        : "linear limit (eigenvalues of the loop in contact)";
  if (!has_linear) {
    if (!beyond)
      return {{},
              fmt::format("every run {} {}, the end of the range, is stable; {}", to, number(*value),
                          without_linear(limit))};
    return {value, fmt::format("simulated limit: {}; {}", next_run(question, limit), without_linear(limit))};
  }
  // Find out whether the simulated limit agrees with the linear limit within the resolution of the search. If not,
  // quote the limit that the field reaches first.
  const double resolution = question.search.range.logarithmic
                                ? question.search.resolution * std::abs(*linear)
                                : question.search.resolution * (question.search.range.to - question.search.range.from);
  const bool agree =
      beyond && std::abs(*value - *linear) <= 2.0 * std::max(resolution, question.search.whole ? 1.0 : 0.0);
  if (agree)
    return {is_first(*value, *linear) ? *value : *linear, name + "; the runs agree" + stable_beyond(question, limit)};
  if (is_first(*value, *linear) && beyond)
    return {value, fmt::format("simulated limit: it is {} than the {}, and {}", smallest ? "larger" : "smaller", name,
                               next_run(question, limit))};
  if (is_first(*value, *linear))
    return {{},
            fmt::format("every run {} {}, the end of the range, is stable; the {} is beyond the range", to,
                        number(*value), name)};
  if (limit.other.value && is_first(*linear, *limit.other.value))
    return {{},
            fmt::format("no value is stable both in runs (stable {} {}) and by the {} (stable {} {})", from,
                        number(*limit.other.value), name, to, number(*linear))};
  return {*linear,
          fmt::format("{}: beyond it a tool that rests in contact is unstable. Runs are stable {} {}{}: {}", name, to,
                      number(*value), beyond ? "" : ", the end of the range", measured_cause(question, limit))};
}

}  // namespace hapbench
