#pragma once

#include "scenarios/import/import_stroke.hpp"
#include "scenarios/input/input_error.hpp"

/// Recordings for the tests of the import, as texts and as bytes.
namespace hapbench::test {

inline const std::filesystem::path kScenarios = HAPBENCH_SCENARIOS;

inline ImportOptions time_and_position() {
  ImportOptions options;
  set_column(options, "time", {"1"});
  set_column(options, "position", {"2"});
  return options;
}

inline ImportedStroke imported(const std::string& text, const ImportOptions& options) {
  return import_stroke(text, "rec.csv", options);
}

/// Empty when nothing is refused.
inline std::string refusal(const std::string& text, const ImportOptions& options = time_and_position()) {
  try {
    imported(text, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// ---- HAPI logs

template <class Number>
std::string hapi_binary(const std::vector<const char*>& names, const std::vector<std::vector<double>>& samples) {
  std::string bytes;
  for (const char* name : names) bytes += std::string(name) + '\0';
  bytes += '\0';
  for (const auto& sample : samples) {
    for (const double value : sample) {
      const auto number = static_cast<Number>(value);
      bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }
  return bytes;
}

inline ImportOptions hapi() {
  ImportOptions options;
  apply_preset(options, (kScenarios / "import/presets/hapi.json").string());
  return options;
}

inline const std::vector<std::vector<double>> kHapiSamples = {{0.5, 0.001, 0.002, 0.003, 0, 1, 0, 0.25, 1, 2, 3},
                                                              {0.51, 0.001, 0.002, 0.004, 0, 1, 0, 0.5, 1, 2, 4}};

}  // namespace hapbench::test
