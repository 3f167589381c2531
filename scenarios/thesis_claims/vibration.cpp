#include "scenarios/thesis_claims/vibration.hpp"

#include <fmt/format.h>

#include "scenarios/thesis_claims/wording.hpp"

namespace hapbench {

MeasuredCase vibration(const std::string& name, const RunSummary& summary) {
  const Metrics& metrics = summary.metrics;
  return {name,
          {{"velocity_variation", {metrics.velocity_total_variation}},
           {"vibration_power", {metrics.vibration_power.value_or(0.0)}},
           {"force_reversals", {static_cast<double>(metrics.force_reversals)}}}};
}

bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] >= kVibratesMore * b["velocity_variation"] &&
         a["vibration_power"] >= kVibratesMore * kVibratesMore * b["vibration_power"];
}

bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] > b["velocity_variation"] && a["vibration_power"] > b["vibration_power"];
}

std::string vibration_rule() {
  return fmt::format("reproduced: {} times the total variation of velocity and {} times the power above 30 Hz",
                     in_words(kVibratesMore), plain(kVibratesMore * kVibratesMore));
}

std::string vibrations_text(const Measured& cases) {
  std::string text;
  for (const MeasuredCase& m : cases) {
    text += fmt::format("{}{}: velocity varies by {:.3g} m/s, power above 30 Hz {:.2g} m²/s², {} force reversals",
                        text.empty() ? "" : "; ", m.name, m["velocity_variation"], m["vibration_power"],
                        m["force_reversals"]);
  }
  return text;
}

}  // namespace hapbench
