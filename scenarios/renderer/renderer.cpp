// The functions of hapbench_renderer.h.

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device_model/live/hapbench_renderer.h"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/renderer/loop_log.hpp"
#include "scenarios/renderer/open_renderer.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/floating_point_mode.hpp"

namespace hapbench {
namespace {

std::vector<std::string> list_of(const char* const* texts) {
  std::vector<std::string> list;
  for (; texts != nullptr && *texts != nullptr; ++texts) list.emplace_back(*texts);
  return list;
}

/// Returns the scenario that setup.scenario gives as a JSON text, a file or a name. Throws InputError.
ScenarioText scenario_text(const HapbenchSetup& setup) {
  if (setup.scenario == nullptr)
    throw InputError("scenario: got NULL; allowed: a name, a file, or a JSON text that begins with \"{\"");
  const std::string_view given = trimmed(setup.scenario);
  if (!given.starts_with('{')) return read_scenario_text(find_scenario(setup.scenario));
  const std::filesystem::path folder = setup.folder != nullptr ? setup.folder : std::filesystem::current_path();
  ScenarioText text = {folder / "scenario text", parse_json(setup.scenario)};
  if (text.json.contains(kExtends))
    throw InputError("scenario text: /extends: is not allowed in a text; allowed: all fields, or a scenario file");
  return text;
}

void check_setup(const HapbenchSetup& setup) {
  const auto refuse = [](const char* field, std::uint32_t got, const std::string& allowed) {
    throw InputError(fmt::format("{}: got {}; allowed: {}", field, got, allowed));
  };
  if (setup.version != HAPBENCH_RENDERER_VERSION)
    refuse("version", setup.version,
           fmt::format("{} (HAPBENCH_RENDERER_VERSION of this library; compile your program anew with its header)",
                       HAPBENCH_RENDERER_VERSION));
  if (setup.mode != HAPBENCH_IMPEDANCE && setup.mode != HAPBENCH_ADMITTANCE)
    refuse("mode", setup.mode, "HAPBENCH_IMPEDANCE (1) or HAPBENCH_ADMITTANCE (2)");
  if ((setup.flags & ~std::uint32_t{HAPBENCH_ALLOW_MODULES | HAPBENCH_TORQUE}) != 0)
    refuse("flags", setup.flags, "HAPBENCH_ALLOW_MODULES (1) and HAPBENCH_TORQUE (2)");
  if (setup.reserved != 0) refuse("reserved", setup.reserved, "0");
  if (setup.modules != nullptr && setup.modules[0] != nullptr && (setup.flags & HAPBENCH_ALLOW_MODULES) == 0)
    throw InputError(
        fmt::format("modules: got {}; allowed: with the flag HAPBENCH_ALLOW_MODULES, because its code would "
                    "be executed",
                    setup.modules[0]));
}

HapbenchRenderer* opened_renderer(const HapbenchSetup& setup) {
  check_setup(setup);
  const ModulePermission permission((setup.flags & HAPBENCH_ALLOW_MODULES) != 0);
  for (const std::string& module : list_of(setup.modules)) load_module(module);
  const std::vector<std::string> overrides = list_of(setup.overrides);
  const CheckedScenario scenario = checked(load_scenario(scenario_text(setup), overrides));
  const RendererSetup mounted = {setup.mode, setup.flags, setup.mount};
  check_mount(mounted);
  check_period(scenario.scenario(), mounted);
  return new_renderer(scenario, mounted);
}

std::size_t copied(std::string_view from, char* text, std::size_t size) {
  if (text != nullptr && size > from.size()) {
    std::copy(from.begin(), from.end(), text);
    text[from.size()] = '\0';
  } else if (text != nullptr && size > 0) {
    text[0] = '\0';
  }
  return from.size();
}

void copy_error(const std::string& problem, char* error) {
  if (error == nullptr) return;
  const std::string line = one_line(problem).substr(0, HAPBENCH_ERROR_SIZE - 1);
  std::memcpy(error, line.c_str(), line.size() + 1);
}

}  // namespace
}  // namespace hapbench

HapbenchRenderer* hapbench_renderer_open(const HapbenchSetup* setup, char* error) {
  const hapbench::FloatingPointMode mode;
  hapbench::copy_error("", error);
  try {
    if (setup == nullptr) throw hapbench::InputError("setup: got NULL; allowed: a setup");
    return hapbench::opened_renderer(*setup);
  } catch (const std::exception& problem) {
    hapbench::copy_error(problem.what(), error);
  } catch (...) {
    hapbench::copy_error("an unknown exception", error);
  }
  return nullptr;
}

uint32_t hapbench_renderer_step(HapbenchRenderer* renderer, const HapbenchInput* input, HapbenchOutput* output) {
  if (renderer == nullptr || input == nullptr || output == nullptr) {
    if (output != nullptr) {
      *output = {};
      output->status = HAPBENCH_FAULT;
      output->reason = HAPBENCH_NULL_ARGUMENT;
    }
    return HAPBENCH_FAULT;
  }
  renderer->live.step(*input, *output);
  return output->status;
}

double hapbench_renderer_period(const HapbenchRenderer* renderer) {
  return renderer == nullptr ? 0.0 : renderer->live.period();
}

const char* hapbench_renderer_inspect(const HapbenchRenderer* renderer) {
  return renderer == nullptr ? "" : renderer->inspection.c_str();
}

const char* hapbench_renderer_fault(const HapbenchRenderer* renderer) {
  return renderer == nullptr ? "the renderer is NULL" : renderer->live.fault();
}

size_t hapbench_renderer_log_header(const HapbenchRenderer* renderer, char* text, size_t size) {
  return hapbench::copied(renderer == nullptr ? "" : std::string_view(renderer->log_header), text, size);
}

size_t hapbench_renderer_log_row(const HapbenchInput* input, const HapbenchOutput* output, char* text, size_t size) {
  if (input == nullptr || output == nullptr) return hapbench::copied("", text, size);
  return hapbench::copied(hapbench::log_row(*input, *output), text, size);
}

void hapbench_renderer_close(HapbenchRenderer* renderer) {
  delete renderer;
}
