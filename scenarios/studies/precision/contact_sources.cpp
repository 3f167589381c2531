#include <cmath>
#include <optional>
#include <string_view>

#include "scenarios/plugins/load_plugin.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/studies/precision/measure.hpp"

/// Compares what a law makes of the contacts of other libraries: at the places where our contacts lead the tool, and
/// along the way on which theirs lead it.
namespace hapbench {
namespace {

/// A place of the tool, and the force of the springs that was rendered there.
struct Place {
  ToolState tool;
  Vec3 spring = Vec3::Zero();  ///< [N]
};

/// The places of every kContactSetStride-th row of a run.
std::vector<Place> places_of(const Scenario& scenario, std::shared_ptr<const PointShell> shell) {
  std::vector<Place> places;
  OnEachRow sampler([&](const StepRecord& record) {
    if (record.step % kContactSetStride == 0) places.push_back({record.tool, record.force.spring});
  });
  Simulation simulation(simulation_config(scenario), assemble(scenario, std::move(shell), {}), {&sampler});
  run_to_end(simulation);
  return places;
}

/// The answers of a source at such places, and how far its spring forces are from those that were rendered there.
struct Answers {
  double contacts = 0.0;     ///< mean number
  double depth = 0.0;        ///< mean of the largest [m]
  double force_error = 0.0;  ///< root of the mean square [N]
};

Answers answers_at(const std::vector<Place>& places, const Scenario& scenario,
                   std::shared_ptr<const PointShell> shell) {
  const SimulationParts parts = assemble(scenario, std::move(shell), {});
  const std::size_t capacity = parts.source->capacity();
  parts.algorithm->prepare({capacity, parts.tool.get(), parts.shell.get(), parts.springs.get(), scenario.time.step});
  parts.algorithm->reset();
  ContactBuffer contacts(capacity);
  Answers sum;
  RenderedForce force;
  for (const Place& place : places) {
    parts.source->contacts_at(place.tool.pose, contacts);
    sum.contacts += static_cast<double>(contacts.size());
    parts.algorithm->compute(place.tool, contacts, force);
    sum.depth += force.depth_max;
    sum.force_error += (force.spring - place.spring).squaredNorm();
  }
  const double n = static_cast<double>(places.size());
  return {sum.contacts / n, sum.depth / n, std::sqrt(sum.force_error / n)};
}

}  // namespace

static PrecisionResult study_contact_sources(const Scenario& given, const PrecisionOptions& options) {
  Scenario scenario = drill_in_hole(given);
  PrecisionResult result;
  result.columns = {"contacts_mean", "depth_max_mean_m", "spring_force_error_rms_N", "way_apart_rms_m"};
  const std::size_t own_columns = result.columns.size();
  result.columns.insert(result.columns.end(), kIdealColumns.begin(), kIdealColumns.end());
  result.timed = "step";
  const auto shell = make_shell(scenario);
  scenario.rendering.contact_source = kOwnContacts;
  const std::vector<Place> places = places_of(scenario, shell);
  std::vector<Vec3> way;
  for (const Place& place : places) way.push_back(place.tool.pose.position);
  const auto add_row = [&](const char* source) {
    scenario.rendering.contact_source = source;
    PrecisionRow row{source, "not built", std::vector<std::optional<double>>(own_columns + kIdealColumns.size())};
    if (source == std::string_view(kOwnContacts) || find_peer(source) != nullptr) {
      IdealRun run = ideal_run(source, scenario, shell, options.repetitions);
      const auto [contacts, depth, error] = answers_at(places, scenario, shell);
      row = std::move(run.row);
      row.values.insert(row.values.begin(), {contacts, depth, error, distance(run.positions, way).rms});
    }
    result.add(std::move(row), options, 1 + kPeers.size());
  };
  add_row(kOwnContacts);
  for (const char* peer : kPeers) add_row(peer);
  return result;
}

const PrecisionStudy kContactSourcesStudy = {
    "contact_sources",
    "what the law makes of the contacts of FCL and Bullet: at our places, and against the ideal trajectory",
    "rotate_in_hole", study_contact_sources};

}  // namespace hapbench
