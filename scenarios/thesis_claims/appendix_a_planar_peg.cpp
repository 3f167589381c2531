#include <fmt/format.h>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/vibration.hpp"

/// Claim of A.1: the planar peg.
namespace hapbench {
namespace {

// ---- A1: the original algorithm and stiffness shaping without friction, which Table A.1 does not list, with that of
// the trainer, and over tilts at the start and speeds of tilting.

constexpr double kTilts[] = {0.02, 0.05, 0.1, 0.2};
constexpr double kRates[] = {0.3, 0.6, 1.2, 3.0};
constexpr const char *kOriginal = "original_averaging", *kShaped = "shaped_stiffness";

MeasuredCase peg(const Evidence& e, const std::string& scene, const std::string& algorithm, const std::string& name,
                 std::span<const std::string> overrides = {}) {
  return vibration(algorithm + ", " + name, e.run(scene + algorithm, overrides).summary);
}

Measured measure_peg_motion(const Evidence& e) {
  const std::string frictionless = "peg_in_hole_2d_frictionless_";
  Measured measured;
  for (const char* algorithm : {kOriginal, kShaped}) measured.push_back(peg(e, frictionless, algorithm, "no friction"));
  for (const char* algorithm : {kOriginal, kShaped})
    measured.push_back(peg(e, "peg_in_hole_2d_", algorithm, "the trainer's friction"));
  for (const double tilt : kTilts) {
    for (const double rate : kRates) {
      const std::string overrides[] = {
          fmt::format(R"(motion.orientation.tilt_rad={{"type":"ramp","start":{},"rate_per_s":{}}})", tilt, rate)};
      for (const char* algorithm : {kOriginal, kShaped})
        measured.push_back(peg(e, frictionless, algorithm, fmt::format("{} rad, {} rad/s", tilt, rate), overrides));
    }
  }
  return measured;
}

Finding judge_peg_motion(const Measured& measured, const PublishedNumbers&) {
  constexpr std::size_t kMap = 4;  // pairs before it: without friction, with it
  std::size_t more = 0, much_more = 0, pairs = 0;
  for (std::size_t i = kMap; i + 1 < measured.size(); i += 2) {
    ++pairs;
    if (vibrates_more(measured[i], measured[i + 1])) ++more;
    if (vibrates_much_more(measured[i], measured[i + 1])) ++much_more;
  }
  const MeasuredCase &original = measured.at(0), &shaped = measured.at(1);
  const Measured shown(measured.begin(), measured.begin() + kMap);
  return {
      decide(vibrates_much_more(original, shaped), vibrates_more(original, shaped)), vibrations_text(shown),
      fmt::format("without friction the original algorithm's velocity varies {:.3g} times as much, with the trainer's "
                  "friction {:.3g} times; of {} tilts and speeds without friction it vibrates much more at {} and "
                  "more at {}",
                  original["velocity_variation"] / shaped["velocity_variation"],
                  measured.at(2)["velocity_variation"] / measured.at(3)["velocity_variation"], pairs, much_more, more)};
}

constexpr Claim kAppendixAPlanarPeg[] = {
    {.id = "A1",
     .place = "A.1.2, Fig. A.2",
     .claim = "the original algorithm vibrates in the planar peg-in-hole, stiffness shaping is smooth",
     .published = "obvious vibration against smooth motion",
     .rule =
         [](const PublishedNumbers&) {
           return vibration_rule() +
                  " as with stiffness shaping, with the parameters of Table A.1; in kind: more of both";
         },
     .measure = measure_peg_motion,
     .judge = judge_peg_motion},
};

}  // namespace

std::span<const Claim> appendix_a_planar_peg() {
  return kAppendixAPlanarPeg;
}

}  // namespace hapbench
