#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/tool/cylinder.hpp"

/// Measurements and scenes that several claims share.
namespace hapbench {

inline const Cylinder kDrill;
inline const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// A wall point with normal +x, `beyond` the median line of an upright tool (so beyond > 0: the tool's axis is inside).
inline ContactBuffer wall_point(double beyond, const char* depth_model) {
  ContactBuffer contacts(1);
  contacts.push(0, {beyond, 0.0, 0.001}, Vec3::UnitX());
  find_depth_model(depth_model)->make()->evaluate(kDrill, kUpright, contacts);
  contacts.pad();
  return contacts;
}

/// Overrides of task 2: the hand pushes with more than the input limit of 2 N all the time, during one rotation of the
/// drill to and fro.
inline const std::vector<std::string> kHandAboveLimit = {
    R"(hand.force_N={"type":"sine","mean":3.5,"amplitude":1.4,"period_s":1.7})", "time.duration_s=6"};

/// Total variation of the velocity [m/s], power of the velocity above 30 Hz [m^2/s^2] and reversals of the force.
MeasuredCase vibration(const std::string& name, const Result& summary);

/// An algorithm vibrates, compared with a smooth one, if it has rule.vibrates times the total variation and the square
/// of it times the power.
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p);
/// True if `a` has more of both.
bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b);

/// The beginning of a rule that compares vibrations.
inline constexpr const char* kVibrationRule =
    "reproduced: <rule.vibrates> times the total variation of velocity, and the square of it times the power above 30 Hz,";
std::string vibrations_text(const Measured& cases);

/// Measures the damping ratio of a swing about zero from the ratio q of successive extremes,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q).
class SwingDecay {
 public:
  /// Extremes closer to zero than this end the decay [m]: rounding and grazing contact are no swings.
  static constexpr double kSmallest = 1e-6;

  /// Adds the coordinate of the next row [m].
  void add(double x);
  /// From the first and the last extreme; none with fewer than two, since a motion that never turns swings not.
  std::optional<double> damping_ratio() const;

 private:
  double before_ = 0.0, last_ = 0.0;
  std::size_t rows_ = 0;
  std::size_t extremes_ = 0;
  bool decayed_ = false;
  double first_extreme_ = 0.0, last_extreme_ = 0.0;
};

/// Instead of a number of iterations: the exact limit.
inline constexpr int kExactLimit = -1;

/// Rounding may lift a result of the search above the true supremum by this much.
inline constexpr double kSearchRounding = 1e-9;

/// Result of a search for contacts that stiffness shaping makes stiff.
struct StiffestContacts {
  double lambda_max = 0.0;  ///< largest eigenvalue of S, in units of K
  std::size_t sets = 0;     ///< of contacts tried
};

/// Climbs from random sets of up to eight weighted directions to ones whose stiffness tensor, after so many iterations
/// of shaping, has a larger and larger largest eigenvalue. The weights before the first iteration stand for many
/// contacts in one direction. The same result on every call; about half a second.
///
/// No set exceeds (1 + sqrt 3)/2, in the plane (1 + sqrt 2)/2, whatever the number of iterations; the proof is in
/// results/reference/BEYOND.md. The search shows that the bound is sharp, and would show an error in the proof.
StiffestContacts stiffest_contacts(int iterations);

}  // namespace hapbench
