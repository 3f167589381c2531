#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "scenarios/studies/stability/scene_devices.hpp"

/// What `limit` asks, and options that other searches take, too.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);
/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// The number that an option was given. Throws InputError unless it is one from `least` to `most`.
double number_between(const char* option, const std::string& text, double least, double most);

/// Appends a text unless it is there already.
void add_once(std::vector<std::string>& texts, const std::string& text);

/// The names that --device takes besides files: "all", "impedance" for every preset, and each device.
std::vector<std::string> device_names();
/// The devices of these names and files, each once; a preset's name with [soft] or [stiff] behind it is the preset at
/// that end of what nobody published of it. Throws InputError.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

struct LimitOptions {
  std::vector<std::string> scenarios;
  std::string field = "rendering.stiffness_N_per_m";
  std::string between, resolution, stable, vibration;
  std::vector<std::string> bounds;
  bool smallest = false;
  std::vector<std::string> algorithms, devices, friction, over;
  unsigned jobs = 0;  ///< 0: as many as the machine has
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;
};

/// Every case of the question, by rows: a device with values of the fields that vary besides; and by columns: a scene
/// with an algorithm.
class LimitCases {
 public:
  /// Loads every case, and prints its warnings. Throws InputError.
  explicit LimitCases(const LimitOptions& options);

  const std::vector<LimitCase>& all() const { return cases_; }
  std::size_t rows() const { return cases_.size() / columns(); }
  std::size_t columns() const { return scenes_.size() * algorithms_of_a_scene(); }
  const LimitCase& at(std::size_t row, std::size_t column) const { return cases_[row * columns() + column]; }

  bool has_devices() const { return !devices_.empty(); }
  /// True where a table of rows and columns shows the limits, and not one of every number.
  bool is_grid() const { return has_devices() || over_; }
  /// Precondition: has_devices().
  const ComparedDevice& device(std::size_t row) const { return devices_[row / points()]; }
  const std::vector<ScenarioText>& scenes() const { return scenes_; }
  /// The name of a scene is that of its file.
  std::string scene_name(std::size_t column) const;
  const std::string& algorithm(std::size_t column) const { return at(0, column).algorithm; }
  /// Paths of the fields that vary besides, and their values.
  std::vector<std::string> over() const;
  std::vector<std::string> values(std::size_t row) const;
  /// The scene of a column as it is on the row's device, with the scenario's value of the field.
  const Scenario& scenario(std::size_t row, std::size_t column) const {
    return scenarios_[row * scenes_.size() + column / algorithms_of_a_scene()];
  }

 private:
  std::size_t points() const { return over_ ? over_->size() : 1; }
  std::size_t algorithms_of_a_scene() const { return algorithms_.empty() ? 1 : algorithms_.size(); }
  std::vector<std::string> overrides(std::size_t row, std::size_t scene) const;
  /// Adds those of a scene with all algorithms. Warnings that are not among them yet are added.
  void add_cases(const LimitOptions& options, std::size_t row, std::size_t scene, std::vector<std::string>& warnings);

  std::vector<ComparedDevice> devices_;  ///< none: each scene's own
  std::vector<ScenarioText> scenes_;
  std::vector<std::string> algorithms_;  ///< none: each scene's own
  std::optional<Cases> over_;
  std::vector<std::string> overrides_;
  std::vector<LimitCase> cases_;
  std::vector<Scenario> scenarios_;  ///< by rows and scenes
};

}  // namespace hapbench
