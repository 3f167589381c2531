#include "scenarios/thesis_claims/finding.hpp"

namespace hapbench {

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::in_kind:
      return "reproduced in kind";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::refuted:
      return "refuted";
    case Verdict::not_reproducible:
      return "not reproducible";
  }
  return "";
}

Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
}

}  // namespace hapbench
