#pragma once

#include <cstddef>
#include <span>
#include <string_view>

/// The verdicts on a run: stable, or the reason why it is not.
namespace hapbench {

/// Verdict on a run: four classes of motion, then outcomes of the run (outcome.hpp), then a violated bound on a metric.
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
/// One of the first kMotionClasses verdicts.
using MotionClass = RunVerdict;
inline constexpr std::size_t kMotionClasses = 4;

/// Name and description of a verdict.
struct RunVerdictText {
  std::string_view name;  ///< name in result files: "stable", "decaying", …
  const char* meaning;    ///< description for the user
  const char* rule = "";  ///< criterion of a class of motion; empty for other verdicts
};
/// Returns the texts of all verdicts, in the order of RunVerdict.
std::span<const RunVerdictText> run_verdict_texts() noexcept;

/// Returns RunVerdictText::name of a verdict.
std::string_view run_verdict_name(RunVerdict verdict) noexcept;

/// Returns true for `stable` and `dying_out` (named "decaying" in results): the tool is at rest, comes to rest or
/// creeps slowly in contact.
bool is_stable(RunVerdict verdict) noexcept;

}  // namespace hapbench
