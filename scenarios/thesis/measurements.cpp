#include "scenarios/thesis/measurements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "algorithms/depth/depth_model.hpp"
#include "results/io/columns.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

void for_each_row(const CheckedScenario& checked, const std::function<void(const StepRecord&)>& row) {
  class RowObserver final : public Observer {
   public:
    explicit RowObserver(const std::function<void(const StepRecord&)>& row_of) : row_(row_of) {}
    bool wants_found() const noexcept override { return true; }
    void on_step(const StepRecord& record) noexcept override { row_(record); }

   private:
    const std::function<void(const StepRecord&)>& row_;
  } observer(row);
  const Scenario& scenario = checked.scenario();
  const auto shell = make_shell(scenario, checked.files());
  Simulation simulation(simulation_config(scenario), assemble(scenario, checked.files(), shell, {}), {&observer});
  run_to_end(simulation);
}

ContactBuffer wall_point(double beyond, const char* depth_model) {
  ContactBuffer contacts(1);
  contacts.push(0, {beyond, 0.0, 0.001}, Vec3::UnitX());
  find_depth_model(depth_model)->make()->evaluate(kDrill, kUpright, contacts);
  contacts.pad();
  return contacts;
}

Scenario drill_in_hole(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  constexpr double kPeriod = 6.0;  // period of the tilt in task 2 [s]
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride, Points points) {
  LoadedScenario loaded;
  loaded.scenario = drill_in_hole(scenario);
  if (points == Points::colliding) {
    loaded.scenario.rendering.reduction.reset();
    loaded.scenario.rendering.local_average = false;
  }
  std::vector<ContactBuffer> sets;
  for_each_row(checked(std::move(loaded)), [&](const StepRecord& row) {
    if (row.step % stride != 0 || row.rendered->empty()) return;
    sets.emplace_back(row.rendered->size()).assign(*row.rendered);
  });
  return sets;
}

ContactBuffer largest_of(const std::vector<ContactBuffer>& sets) {
  if (sets.empty()) throw NothingToMeasure("no step of the run has a contact");
  return *std::ranges::max_element(sets, {}, &ContactBuffer::size);
}

std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  return sets.empty() ? 0 : largest_of(sets).size();
}

MeasuredCase vibration(const std::string& name, const Result& run) {
  const auto number = [&](const char* metric) { return number_of(run.metrics, metric).value_or(0.0); };
  return {name,
          {{"velocity_variation", {number("velocity_total_variation_m_per_s")}},
           {"vibration_power", {number("vibration_power_above_30Hz_m2_per_s2")}},
           {"force_reversals", {number("force_reversals")}}}};
}

MeasuredCase reference_vibration(const std::string& name, const Result& run) {
  MeasuredCase m = vibration(name, run);
  if (run.end.outcome == Outcome::diverges)
    for (const auto& [value, numbers] : MeasuredValues(m.values)) m.set_diverged(value, numbers.front());
  return m;
}

MeasuredCase until_divergence(MeasuredCase reference) {
  for (const char* value : {"velocity_variation", "vibration_power", "force_reversals"})
    reference.values[value] = {reference.until_divergence(value)};
  return reference;
}

bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] > b["velocity_variation"] && a["vibration_power"] > b["vibration_power"];
}

bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p) {
  const double more = threshold(p, "vibrates");
  const bool moves = a["velocity_variation"] >= more * b["velocity_variation"] &&
                     a["vibration_power"] >= more * more * b["vibration_power"];
  return moves || (vibrates_more(a, b) && a["force_reversals"] >= more * std::max(1.0, b["force_reversals"]));
}

std::optional<double> damping_ratio_of_swings(std::span<const double> x) {
  constexpr double kSmallest = 1e-6;  // smallest magnitude of an extreme that counts [m]
  // Collect the magnitudes of the extremes.
  std::vector<double> extremes;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    if ((x[i] - x[i - 1]) * (x[i + 1] - x[i]) >= 0.0) continue;
    if (std::abs(x[i]) < kSmallest) break;
    extremes.push_back(std::abs(x[i]));
  }
  if (extremes.size() < 2) return std::nullopt;
  const double q = math::pow(extremes.back() / extremes.front(), 1.0 / static_cast<double>(extremes.size() - 1));
  if (q >= 1.0) return 0.0;
  const double log_q = math::log(q);
  return -log_q / std::sqrt(std::numbers::pi * std::numbers::pi + log_q * log_q);
}

}  // namespace hapbench
