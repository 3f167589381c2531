#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"

/// Runs scenes with their diagnosis.
namespace hapbench::test {

using Words = std::vector<std::string>;

struct Scene {
  const char* name;
  Words overrides = {};
};

/// Returns the run of a scene with its overrides. The expectations of the file are replaced by the default expectation.
inline Result run(const Scene& scene, Diagnose diagnose = Diagnose::everything) {
  Words overrides = {"expect={}", "record.trajectory=false"};
  overrides.insert(overrides.end(), scene.overrides.begin(), scene.overrides.end());
  return run_scenario(checked(load_scenario(find_scenario(scene.name), overrides)), std::nullopt, false, nullptr,
                      diagnose);
}

/// Returns the diagnosed run of a scene that a test writes as JSON.
inline Result run_of_text(const std::string& scene) {
  const TemporaryDirectory folder;
  const std::string file = folder / "scene.json";
  write_plainly(file, scene);
  return run({file.c_str()});
}

/// Returns the finding of the rule; null if the rule finds nothing.
inline const Diagnosed* finding(const Result& run, std::string_view rule) {
  const auto found = std::ranges::find(*run.diagnosis, rule, &Diagnosed::rule);
  return found == run.diagnosis->end() ? nullptr : &*found;
}

}  // namespace hapbench::test
