#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "algorithms/registry.hpp"
#include "bindings/bindings.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"

/// The engine and the commands of the program for Python. Users call the package around it (hapbench/).
namespace hapbench {
namespace {

namespace py = pybind11;

/// Raises InputError and IoError as hapbench.ScenarioError and OSError.
void translate_errors() {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const InputError& error) {
      py::list faults;
      for (const InputError& fault : error.faults()) faults.append(py::make_tuple(fault.place(), fault.problem()));
      const py::object type = py::module_::import("hapbench.errors").attr("ScenarioError");
      PyErr_SetObject(type.ptr(), type(faults).ptr());
    } catch (const IoError& error) {
      PyErr_SetString(PyExc_OSError, error.what());
    }
  });
}

/// Name, unit and meaning of each column, and the numbers as an array of rows x columns.
py::tuple table_of(const MemoryTable& table) {
  py::list columns;
  for (const Column& column : table.columns()) columns.append(py::make_tuple(column.name, column.unit, column.meaning));
  return py::make_tuple(columns, py::array_t<double>({table.rows(), table.columns().size()}, table.numbers().data()));
}

py::dict run(const std::string& scenario, const std::vector<std::string>& overrides, const py::object& progress) {
  Result report;
  RunTables tables;
  std::vector<std::string> warnings;
  const bool shown = progress.ptr() != Py_False;
  supervise(progress, [&] {
    const LoadedScenario loaded = checked(load_scenario(find_scenario(scenario), overrides));
    warnings = with_files(loaded, loaded.warnings);
    for (std::string& warning : with_files(loaded, loaded.file_warnings)) warnings.push_back(std::move(warning));
    report = run_scenario(loaded, std::nullopt, shown, &tables);
    for (std::string& warning : run_warnings({&report, 1})) warnings.push_back(std::move(warning));
  });
  py::dict result;
  result["summary"] = summary_text(report);
  result["scenario"] = json_text(tables.effective);
  result["timing"] = timing_text(report.timing, instruction_set(), report.provenance);
  result["warnings"] = warnings;
  result["unmet"] = report.unmet;
  py::list trials;
  for (const RecordedTables& trial : tables.trials) {
    py::dict recorded;
    for (const auto& [file, table] : trial)
      recorded[py::str(std::filesystem::path(file).stem().string())] = table_of(table);
    trials.append(recorded);
  }
  result["trials"] = trials;
  result["targets"] = tables.targets ? py::object(table_of(*tables.targets)) : py::object(py::none());
  return result;
}

int call(int (*program)(int, char**), std::vector<std::string> words) {
  words.insert(words.begin(), "hapbench");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return program(static_cast<int>(words.size()), pointers.data());
}

py::tuple command(const std::vector<std::string>& words, const py::object& progress) {
  CapturedOutput output;
  int status = 0;
  supervise(progress, [&] {
    captured_output() = &output;
    status = call(run_program, words);
  });
  return py::make_tuple(status, output.text, output.warnings, output.errors);
}

int be_program(const std::vector<std::string>& words) {
  int status = 0;
  supervise(py::none(), [&] { status = call(run_program_to_exit, words); });
  return status;
}

}  // namespace
}  // namespace hapbench

PYBIND11_MODULE(_hapbench, module) {
  using namespace hapbench;
  module.doc() = "The compiled part of hapbench: use the package around it.";
  translate_errors();
  guard_law_loading();
  end_work_before_interpreter();
  module.def(
      "set_program", [](const std::string& program) { this_program() = program; }, py::arg("program"),
      "Say which file is the program, for commands that name it.");
  module.def("run", run, py::arg("scenario"), py::arg("overrides"), py::arg("progress"),
             "Run a scenario and keep what it records in memory.");
  module.def("command", command, py::arg("words"), py::arg("progress"),
             "Run a command of the program; returns status, standard output, warnings and errors.");
  module.def("main", be_program, py::arg("words"), "Be the program: print on the terminal and return the exit status.");
  module.def(
      "algorithms", [] { return algorithm_names(); }, "The names of all algorithms there are.");
  bind_force_laws(module);
  bind_simulation(module);
}
