#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "algorithms/module/module.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/recordings.hpp"
#include "sim/geometry/analytic_shells.hpp"

/// Targets for libFuzzer: each reader of external files, with bytes from libFuzzer (scripts/fuzz). The reader must
/// accept them or throw an InputError of one line; everything else is a finding.
namespace hapbench::fuzz {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

void require(bool holds, const char* what) {
  if (!holds) finding(what);
}

/// Writes these bytes to a file and returns the path of the file. The file is in the memory file system /dev/shm if
/// that exists, otherwise in the directory for temporary files.
const fs::path& file_with(std::string_view bytes) {
  static const fs::path file = (fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) /
                               ("hapbench-fuzz-" + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

const fs::path kBundled = fs::path(HAPBENCH_SCENARIOS) / "examples";

/// Checks that an accepted text is a scenario: reading its effective form gives the same scenario.
void read_scenario_text(std::string_view text) {
  const Json effective = effective_scenario(read_scenario(parse_json(std::string(text)), kBundled).scenario, kBundled);
  require(effective_scenario(read_scenario(effective, kBundled).scenario, kBundled) == effective,
          "an effective scenario reads as another one");
}

/// Returns the approximate number of points of an environment; 0 if a file determines the number.
double points_of(const Environment& environment) {
  return std::visit(
      []<class Shape>(const Shape& shape) {
        if constexpr (std::is_same_v<Shape, BlockEnvironment>) {
          return 6.0 * std::pow(shape.block.size.maxCoeff() / shape.grid, 2);
        } else if constexpr (requires { point_count(shape); }) {
          return point_count(shape);
        } else {
          return 0.0;
        }
      },
      environment);
}

/// Reads a scenario and runs its first steps. To save time, a field environment.spacing_m is multiplied by four, so
/// that a surface has about a sixteenth of its points.
void run_scenario_text(std::string_view text) {
  Json json = effective_scenario(read_scenario(parse_json(std::string(text)), kBundled).scenario, kBundled);
  if (Json& environment = json["environment"];
      environment.contains("spacing_m") && environment["spacing_m"].is_number())
    environment["spacing_m"] = 4.0 * environment["spacing_m"].get<double>();
  LoadedScenario loaded = read_scenario(json, kBundled);
  // Skip larger environments, because they are slower and find no other errors.
  constexpr double kMaxSurfacePoints = 1e5;
  constexpr std::int64_t kMaxSteps = 20;
  const auto* tool = std::get_if<MeshToolFields>(&loaded.scenario.tool);
  if (points_of(loaded.scenario.environment) > kMaxSurfacePoints || (tool != nullptr && tool->grid)) return;
  loaded.scenario.time.steps = std::min(loaded.scenario.time.steps, kMaxSteps);
  run_scenario(checked(loaded), std::nullopt, false);
}

void require_points(const std::vector<SurfacePoint>& points) {
  require(!points.empty(), "no points");
  for (const SurfacePoint& point : points) {
    require(point.position.cwiseAbs().maxCoeff() <= 1000.0, "a point beyond 1 km");
    require(std::abs(point.normal.norm() - 1.0) <= 1e-12, "a normal that is not unit");
  }
}

template <const char* name>
void read_mesh(std::string_view bytes) {
  require_points(MeshFile(bytes, name, {}).points());
}

template <const char* name>
void read_shell(std::string_view bytes) {
  require_points(parse_point_shell(bytes, name));
}

void read_stroke(std::string_view text) {
  const auto [motion, force] = parse_stroke(text, "stroke.csv");
  require(std::abs(motion.axis_at(1e9).norm() - 1.0) <= 1e-12, "an axis that is not unit");
}

void read_trace(std::string_view text) {
  const ContactTrace trace = parse_contact_trace(text, "trace.csv");
  for (const ContactTrace::Contact& contact : trace.contacts)
    require(std::abs(contact.gradient.norm() - 1.0) <= 2e-12 && contact.depth >= 0.0, "a contact that cannot be used");
  require(trace.max_contacts() <= trace.contacts.size(), "more contacts at a time than there are");
}

/// Opens the bytes as a finished table. The table must be rejected, or must count no more rows than it has passed to
/// the function that decides which rows are kept.
void read_table(std::string_view text) {
  const fs::path folder = file_with("").parent_path(), name = file_with("").filename();
  const fs::path file = folder / (name.string() + ".csv"), part = folder / (name.string() + ".csv.part");
  fs::rename(file_with(text), file);
  std::ofstream(folder / (name.string() + ".json")) << R"({"definition": "fuzz"})";
  std::size_t rows = 0;
  const TableFile table({file, "index,a", {{"definition", "fuzz"}}, 100},
                        [&rows](std::size_t, std::string_view row) { return csv_cells(row).size() > ++rows % 2; });
  require(table.count() <= rows, "a row that was not told");
  fs::remove(part);
}

/// Reads a device file, as `limit --device` does.
void read_device(std::string_view text) {
  device_of_file(file_with(text));
}

/// Creates the module table of a law whose texts and numbers are taken from `bytes`. The program must accept the law or
/// reject it with an error message.
void read_module(std::string_view bytes) {
  std::vector<std::string> texts;  // texts between zero bytes, at least 8
  std::istringstream in{std::string(bytes)};
  for (std::string text; std::getline(in, text, '\0');) texts.push_back(text);
  texts.resize(std::max<std::size_t>(texts.size(), 8));
  const auto text = [&texts](std::size_t i) { return texts[i].starts_with('-') ? nullptr : texts[i].c_str(); };
  std::vector<HapbenchParameter> parameters;
  for (std::size_t i = 8; i + 2 < texts.size(); i += 3) {
    std::array<double, 3> numbers = {0.0, 1.0, 0.5};
    std::memcpy(numbers.data(), texts[i].data(), std::min(sizeof numbers, texts[i].size()));
    parameters.push_back({text(i + 1), text(i + 2), numbers[0], numbers[1], numbers[2], text(5)});
  }
  auto table = std::make_shared<HapbenchModule>();
  table->version = HAPBENCH_MODULE_VERSION;
  table->kind = HAPBENCH_LAW;
  table->name = text(0);
  table->summary = text(1);
  table->formula = text(2);
  table->source = text(3);
  table->known_failure = text(4);
  table->parameters = texts[7].starts_with('-') ? nullptr : parameters.data();
  table->parameter_count = parameters.size() + (texts[7].starts_with('+') ? std::size_t{1} << 40 : 0);
  table->step = [](void*, const HapbenchPose*, HapbenchContacts*, HapbenchForce*, char*) { return 0; };
  try {
    law_entry({table, "fuzz.so"}, "");
  } catch (const std::invalid_argument&) {
  }
}

constexpr char kObj[] = "x.obj", kPly[] = "x.ply", kStl[] = "x.stl", kOff[] = "x.off", kCsv[] = "x.csv";

struct Target {
  std::string_view name;
  void (*read)(std::string_view bytes);
};
constexpr std::array kTargets = {
    Target{"scenario", read_scenario_text},
    Target{"run", run_scenario_text},
    Target{"mesh_obj", read_mesh<kObj>},
    Target{"mesh_ply", read_mesh<kPly>},
    Target{"mesh_stl", read_mesh<kStl>},
    Target{"mesh_off", read_mesh<kOff>},
    Target{"shell_csv", read_shell<kCsv>},
    Target{"shell_ply", read_shell<kPly>},
    Target{"stroke", read_stroke},
    Target{"table", read_table},
    Target{"device", read_device},
    Target{"module", read_module},
    Target{"trace", read_trace},
};

/// Returns the target that the environment variable FUZZ_TARGET names. Exits with status 2 if there is no such target.
const Target& target() {
  const char* name = std::getenv("FUZZ_TARGET");
  for (const Target& t : kTargets) {
    if (name != nullptr && t.name == name) return t;
  }
  std::fprintf(stderr, "FUZZ_TARGET:");
  for (const Target& t : kTargets) std::fprintf(stderr, " %s", t.name.data());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace
}  // namespace hapbench::fuzz

/// Exits if FUZZ_TARGET names no target, before libFuzzer could report this as a crash.
extern "C" int LLVMFuzzerInitialize(int*, char***) {  // NOLINT: the name is libFuzzer's
  hapbench::fuzz::target();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hapbench;
  static const fuzz::Target& target = fuzz::target();
  try {
    target.read({reinterpret_cast<const char*>(data), size});
  } catch (const InputError& error) {
    const std::string message = error.what();
    fuzz::require(message.find_first_of(std::string("\n\r\0\x1b", 4)) == std::string::npos,
                  "a message of several lines");
    fuzz::require(message.size() < 5000, "a message of more than 5000 characters");
  } catch (const std::exception& error) {
    fuzz::finding(error.what());
  }
  return 0;
}
