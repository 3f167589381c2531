#include "scenarios/run/checked_scenario.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "scenarios/input/input_error.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/tools.hpp"

namespace hapbench {
namespace {

/// Throws InputError if the scenario records a force reference but the stroke file has no measured force.
void check_force_reference(const LoadedScenario& loaded, NamedFile& file) {
  const Scenario& scenario = loaded.scenario;
  if (!scenario.record.force_reference || scenario.reference_force || file.stroke()->force) return;
  constexpr const char* kReference = "/record/force_reference";
  fail_in({.file = file_of(loaded, kReference), .pointer = kReference},
          fmt::format("got true; allowed: false, because {} has no columns mfx_N,mfy_N,mfz_N", file.path().string()));
}

/// Returns a warning if the stroke's times and the run's times do not overlap.
std::optional<Warning> clock_warning(const Stroke& stroke, const TimeFields& time) {
  const double start = stroke.motion.samples().front().time, stop = stroke.motion.samples().back().time;
  const double end = time.step * static_cast<double>(time.steps - 1);
  if (start <= end && stop >= 0.0) return std::nullopt;
  return Warning{
      "stroke_clock", std::string(kMotionFile),
      fmt::format("the stroke's clock runs from {:.6g} to {:.6g} s and the run's from 0 to {:.6g} s: the tool "
                  "stays at the {} sample; let the stroke begin at 0 or adapt time",
                  start, stop, end, start > end ? "first" : "last")};
}

}  // namespace

CheckedScenario checked(LoadedScenario loaded) {
  const Scenario& scenario = loaded.scenario;
  std::vector<Warning> warnings;
  // Load the library of contacts.
  if (scenario.rendering.contact_source == kContactPlugin)
    with_file(loaded, [&] { require_contacts_in(scenario.directory / scenario.rendering.contact_file); });
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
  // Compare the stroke with the run.
  if (NamedFile* const file = loaded.files.find(kMotionFile)) {
    check_force_reference(loaded, *file);
    if (auto warning = clock_warning(*file->stroke(), scenario.time)) warnings.push_back(std::move(*warning));
  }
  return CheckedScenario(std::move(loaded), std::move(warnings));
}

}  // namespace hapbench
