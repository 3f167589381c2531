#include "scenarios/run/checked_scenario.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "scenarios/input/input_error.hpp"
#include "scenarios/run/clock_coverage.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/tools.hpp"

namespace hapbench {
namespace {

/// Throws InputError if the scenario records a reference force but has none: it has no field reference_force, and the
/// stroke file has no measured force.
void check_force_reference(const LoadedScenario& loaded, NamedFile& file) {
  const Scenario& scenario = loaded.scenario;
  if (!scenario.record.force_reference || scenario.reference_force || file.stroke()->force) return;
  constexpr const char* kReference = "/record/force_reference";
  fail_in({.file = file_of(loaded, kReference), .pointer = kReference},
          fmt::format("got true; allowed: false, because {} has no columns mfx_N,mfy_N,mfz_N", file.path().string()));
}

}  // namespace

CheckedScenario checked(LoadedScenario loaded, Libraries libraries) {
  const Scenario& scenario = loaded.scenario;
  std::vector<Warning> warnings;
  // Load or inspect the library of contacts.
  if (scenario.rendering.contact_source == kContactPlugin) {
    const auto use = libraries == Libraries::loaded ? require_contacts_in : inspect_module;
    with_file(loaded, [&] { use(scenario.directory / scenario.rendering.contact_file); });
  }
  // Read and parse each file, and collect its warnings.
  for (const auto& file : loaded.files.all()) {
    try {
      file->check();
      if (file->pointer() == kToolFile) make_tool(scenario, loaded.files);  // throws if the tool's mesh is not closed
    } catch (const InputError& error) {
      fail_in({.file = file_of(loaded, file->pointer()), .pointer = file->pointer()}, error.what());
    }
    for (Warning& warning : file->warnings()) warnings.push_back(std::move(warning));
  }
  // Compare the clocks of recordings with the clock of the run.
  if (NamedFile* const file = loaded.files.find(kMotionFile)) {
    check_force_reference(loaded, *file);
    if (auto warning = stroke_clock_warning(*file->stroke(), scenario.time)) warnings.push_back(std::move(*warning));
  }
  if (scenario.rendering.contact_source == kTrace) {
    const std::int64_t every = scenario.rendering.multi_rate ? scenario.rendering.multi_rate->every : 1;
    const ContactTrace& trace = *loaded.files.at(kContactFile).trace();
    if (auto warning = trace_clock_warning(trace, scenario.time, every)) warnings.push_back(std::move(*warning));
    if (auto warning = trace_size_warning(trace, *make_tool(scenario, loaded.files)))
      warnings.push_back(std::move(*warning));
  }
  return CheckedScenario(std::move(loaded), std::move(warnings));
}

}  // namespace hapbench
