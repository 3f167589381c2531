#pragma once

#include <cstddef>
#include <span>
#include <string_view>

/// The verdicts on a run: stable, or the reason why it is not.
namespace hapbench {

/// Classes of motion, then outcomes of a run of the same name, then a bound on a metric that is not kept.
enum class RunVerdict {
  stable,
  dying_out,
  vibrating,
  diverged,
  thrown_out,
  no_contact,
  lost_contact,
  went_through,
  not_dragged,
  stuck,
  beyond_bound
};
/// One of the first four.
using MotionClass = RunVerdict;
inline constexpr std::size_t kMotionClasses = 4;

/// A verdict in words.
struct RunVerdictText {
  std::string_view name;  ///< also in result files: "stable", "dying_out", ...
  const char* meaning;
  const char* rule = "";  ///< by which a run belongs to a class of motion
};
/// Returns the texts in the order of the enumeration.
std::span<const RunVerdictText> run_verdict_texts() noexcept;

std::string_view run_verdict_name(RunVerdict verdict) noexcept;

/// Returns true for runs that come to rest in contact: stable and dying_out.
bool is_stable(RunVerdict verdict) noexcept;

}  // namespace hapbench
