#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/studies/convergence/convergence.hpp"

/// How sure the numbers of a run are: their digits, and the short convergence studies of `run --sure` and `compare
/// --sure`.
namespace hapbench {

/// A number with the digits that its error leaves it: one where the error is larger, six where it is 0, four where it
/// is not known.
std::string sure_number(double value, const std::optional<double>& error);
/// The same with the error behind: "1.234 +- 0.005".
std::string sure_text(double value, const std::optional<double>& error);

/// The metrics of a scene's runs, a run for each algorithm, at the step and the distance of points of the scenario and
/// at a half and a quarter of either.
class SureStudy {
 public:
  /// Runs it, with the files of its sweeps in `directory`/sure_step and `directory`/sure_spacing. Without algorithms
  /// the scenario's own. Throws InputError, IoError and Stopped.
  SureStudy(const ScenarioText& scenario, const std::vector<std::string>& overrides,
            const std::vector<std::string>& algorithms, const std::filesystem::path& directory, unsigned jobs,
            const OutputOptions& output);

  struct Number {
    std::optional<double> value, step = {}, spacing = {};  ///< of the run, and its errors by either if they are known
    std::optional<double> error = {};  ///< their sum; none where one that there is to know is not known
  };
  Number number(std::size_t algorithm, const std::string& metric) const;

  /// A table with a row for each of the names, one of each algorithm, and what was refined.
  std::string text(const std::string& title, const std::vector<std::string>& names) const;
  /// Value and errors of every metric of an algorithm's run.
  Json json(std::size_t algorithm) const;

 private:
  struct Part {
    LevelSweep levels;
    SweepPlan plan;
    SweepReport report;
  };
  std::optional<Part> step_, spacing_;
  std::string no_spacing_;  ///< why there is no part of that name
};

}  // namespace hapbench
