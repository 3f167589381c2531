#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "algorithms/rendering_config.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/import/import_stroke.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/quantity_text.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// As given; empty or negative where not.
struct ImportWords {
  std::string file, preset, format, orientation, out;
  std::vector<std::string> columns, scale, tip_axis, frame, shift, smooth;
  double rate = -1.0, sample_rate = -1.0, max_speed = -1.0, max_gap = -1.0;
  bool floats = false, force_by_tool = false, skip_bad_rows = false, list = false;
  OutputOptions output;
};

double number_word(const char* option, std::string_view word) {
  if (const auto number = finite_number(word)) return *number;
  throw InputError(fmt::format("{}: got {}; allowed: a number", option, quoted_word(word)));
}

/// Calls `use` with the parts of each NAME=VALUE.
template <class Use>
void for_assignments(const char* option, const std::vector<std::string>& words, Use use) {
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError(fmt::format("{}: got {}; allowed: NAME=VALUE", option, quoted_word(word)));
    use(word.substr(0, equals), word.substr(equals + 1));
  }
}

Vec3 vector_words(const char* option, const std::vector<std::string>& words) {
  if (words.size() != 3) throw InputError(fmt::format("{}: got {} numbers; allowed: three", option, words.size()));
  return {number_word(option, words[0]), number_word(option, words[1]), number_word(option, words[2])};
}

Smoothing smoothing_of(const std::vector<std::string>& words) {
  Smoothing smoothing;
  for_assignments("--smooth", words, [&](const std::string& name, const std::string& value) {
    const auto number = whole_number(value);
    if (!number || *number > 100'000)
      throw InputError(fmt::format("--smooth: {}: got {}; allowed: a whole number", name, quoted_word(value)));
    require_valid_name("--smooth: got", name, std::vector<std::string>{"window", "order"});
    (name == "window" ? smoothing.window : smoothing.order) = static_cast<int>(*number);
  });
  return smoothing;
}

/// The preset, and over it what is given.
ImportOptions import_options(const ImportWords& words) {
  ImportOptions options;
  if (!words.preset.empty()) apply_preset(options, words.preset);
  if (!words.format.empty()) set_format(options, words.format);
  if (!words.orientation.empty()) set_orientation(options, words.orientation);
  for_assignments("--columns", words.columns, [&](const std::string& quantity, const std::string& column) {
    set_column(options, quantity, {column});
    if (quantity == "time") options.sample_rate.reset();
  });
  for_assignments("--scale", words.scale, [&](const std::string& quantity, const std::string& factor) {
    set_scale(options, quantity, number_word("--scale", factor));
  });
  if (!words.tip_axis.empty()) options.tip_axis = vector_words("--tip-axis", words.tip_axis);
  if (!words.frame.empty()) set_frame(options, words.frame);
  if (!words.shift.empty()) options.shift = vector_words("--shift", words.shift);
  if (!words.smooth.empty()) options.smoothing = smoothing_of(words.smooth);
  if (words.sample_rate >= 0.0) options.sample_rate = words.sample_rate;
  if (words.rate >= 0.0) options.rate = words.rate;
  if (words.max_speed >= 0.0) options.most_speed = words.max_speed;
  if (words.max_gap >= 0.0) options.longest_gap = words.max_gap;
  options.floats = options.floats || words.floats;
  options.force_by_tool = options.force_by_tool != words.force_by_tool;
  options.skip_bad_rows = words.skip_bad_rows;
  return options;
}

int list_presets(const OutputOptions& output) {
  Table table({{"PRESET", false}, {"of", false}});
  Json json = Json::array();
  for (const ImportPreset& preset : import_presets()) {
    table.add({preset.name, preset.description});
    json.push_back({{"preset", preset.name}, {"description", preset.description}, {"file", preset.file.string()}});
  }
  const std::string folder = import_presets().empty() ? "" : import_presets().front().file.parent_path().string();
  print(output,
        table.text() + fmt::format("\nCopy one from {}, correct it and give it as --preset FILE.json.\n", folder),
        json);
  return kSuccess;
}

std::string quantum_text(const std::optional<double>& quantum) {
  return quantum ? fmt::format("{:.4g} um", 1e6 * *quantum) : "none";
}

Table report_table(const ImportReport& r) {
  Table table({{"of the stroke", false}, {"", false}});
  const auto add = [&table](const char* what, const std::string& text) { table.add({what, text}); };
  add("rows", r.rows_left_out == 0 ? fmt::format("{} read, all used", r.rows_read)
                                   : fmt::format("{} read, {} bad ones left out", r.rows_read, r.rows_left_out));
  add("clock", fmt::format("began at {:.9g} s; intervals {:.4g} ms in the median, {:.4g} ... {:.4g} ms", r.clock.first,
                           1e3 * r.clock.interval_median, 1e3 * r.clock.interval_min, 1e3 * r.clock.interval_max));
  add("stroke", fmt::format("{:.6g} s in {} samples, {:.6g} Hz{}", r.clock.duration, r.samples, r.rate,
                            r.resampled ? ", resampled" : ""));
  add("gaps", r.gaps.empty() ? "none (of ten median intervals and more)" : fmt::format("{}, bridged", r.gaps.size()));
  add("tip", fmt::format("{} ({})", size_text(r.box), place_text(r.box)));
  add("speed", fmt::format("{:.4g} m/s at most, 99 % below {:.4g} m/s", r.speed_max, r.speed_p99));
  add("pose", r.has_roll ? fmt::format("quaternions; norms were within {:.1e} of 1", r.unit_deviation)
                         : "the axis alone; the roll is unknown");
  add("quantum", fmt::format("x {}, y {}, z {}", quantum_text(r.quantum[0]), quantum_text(r.quantum[1]),
                             quantum_text(r.quantum[2])));
  const double stiffness = RenderingConfig().stiffness;
  if (const auto quantum = r.coarsest())
    add("", fmt::format("alone makes steps of K q = {:.4g} N at the default K = {:g} N/m", stiffness * *quantum,
                        stiffness));
  if (r.smoothing)
    add("smoothing",
        fmt::format("moved the tip by {:.4g} um at most, {:.4g} um rms; turned it by {:.4g} mrad, {:.4g} rms",
                    1e6 * r.smoothing->position_largest, 1e6 * r.smoothing->position_rms,
                    1e3 * r.smoothing->angle_largest, 1e3 * r.smoothing->angle_rms));
  add("force", r.force_max ? fmt::format("measured, {:.4g} ... {:.4g} N", *r.force_min, *r.force_max) : "not measured");
  return table;
}

Json number_or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

Json report_json(const fs::path& out, const ImportReport& r) {
  const auto vector = [](const Vec3& v) { return Json({v.x(), v.y(), v.z()}); };
  Json json = {
      {"file", out.string()},
      {"rows_read", r.rows_read},
      {"rows_left_out", r.rows_left_out},
      {"samples", r.samples},
      {"rate_Hz", r.rate},
      {"resampled", r.resampled},
      {"first_time_s", r.clock.first},
      {"duration_s", r.clock.duration},
      {"interval_s",
       {{"min", r.clock.interval_min}, {"median", r.clock.interval_median}, {"max", r.clock.interval_max}}},
      {"gaps", r.gaps.size()},
      {"box_m", {vector(r.box.min), vector(r.box.max)}},
      {"speed_p99_m_per_s", r.speed_p99},
      {"speed_max_m_per_s", r.speed_max},
      {"has_roll", r.has_roll},
      {"unit_deviation", r.unit_deviation},
      {"quantum_m", {number_or_null(r.quantum[0]), number_or_null(r.quantum[1]), number_or_null(r.quantum[2])}},
      {"quantum_force_N", nullptr},
      {"force_min_N", number_or_null(r.force_min)},
      {"force_max_N", number_or_null(r.force_max)},
      {"smoothing", nullptr},
      {"warnings", r.warnings}};
  if (const auto quantum = r.coarsest()) json["quantum_force_N"] = RenderingConfig().stiffness * *quantum;
  if (r.smoothing)
    json["smoothing"] = {{"position_largest_m", r.smoothing->position_largest},
                         {"position_rms_m", r.smoothing->position_rms},
                         {"angle_largest_rad", r.smoothing->angle_largest},
                         {"angle_rms_rad", r.smoothing->angle_rms}};
  return json;
}

int import(const ImportWords& words) {
  if (words.list) return list_presets(words.output);
  if (words.file.empty()) throw InputError("FILE is missing: the recording; \"hapbench import --help\" explains");
  if (words.preset.empty() && words.columns.empty())
    throw InputError("--columns or --preset is missing: which columns hold time and position?");
  const ImportOptions options = import_options(words);
  const fs::path file = words.file;
  const fs::path out = words.out.empty() ? fs::path(file.stem().string() + "_stroke.csv") : fs::path(words.out);
  std::error_code ignored;
  if (fs::equivalent(file, out, ignored))
    throw InputError(fmt::format("--out {}: is the recording itself; allowed: another file", out.string()));
  const std::string bytes = read_named_file(file);
  const ImportedStroke stroke = import_stroke(bytes, file, options);
  print_warnings(stroke.report.warnings);
  require_writable_directory(out.has_parent_path() ? out.parent_path() : ".");
  write_file_atomically(out, stroke_text(stroke.samples));

  const std::string scenario = out.stem().string() + ".json";
  const std::string next = shell_line({"hapbench", "new", "stroke", "--from", out.string(), "--out", scenario}) +
                           " && " + shell_line({"hapbench", "run", scenario});
  Json json = report_json(out, stroke.report);
  json["next"] = next;
  print(words.output, fmt::format("{}\n{}\nnext: {}\n", out.string(), report_table(stroke.report).text(), next), json);
  return kSuccess;
}

}  // namespace

void add_import(CommandLine& line) {
  auto words = std::make_shared<ImportWords>();
  Command command = line.command("import", "Make a stroke to play back from a recording: poses and measured forces");
  command.add("file", words->file, "the recording");
  command.add("--preset", words->preset, "a layout by name or from FILE.json; options below override it").words([] {
    std::vector<std::string> names;
    for (const ImportPreset& preset : import_presets()) names.push_back(preset.name);
    return names;
  });
  command.flag("--list", words->list, "list the presets");
  command.add("--format", words->format, "csv (default), traj (blanks between numbers), hapi, hapi-binary")
      .one_of(stroke_format_names());
  command.flag("--floats", words->floats, "hapi-binary: numbers of four bytes");
  command.add("--columns", words->columns, "where quantities are, by name or number from 1 (below)").comma_separated();
  command.add("--scale", words->scale, "what units are: time [s], position [m], angle [rad], force [N] (below)")
      .comma_separated();
  command.add("--sample-rate", words->sample_rate, "[Hz] of a file without a column of times");
  command.add("--orientation", words->orientation, "what its columns hold; default none: the tool never turns")
      .one_of(orientation_names());
  command.add("--tip-axis", words->tip_axis, "x,y,z: direction out of the tip in the tool's frame; default 0,0,-1")
      .comma_separated();
  command.add("--frame", words->frame, "recorded directions that are the scenario's x, y, z; y up: x,-z,y")
      .comma_separated();
  command.add("--shift", words->shift, "x,y,z: added to the places of the tip [m], in the scenario's frame")
      .comma_separated();
  command.flag("--force-by-tool", words->force_by_tool,
               "forces are the tool's on the object, not the object's on the tool: turn them round");
  command.add("--rate", words->rate, "[Hz] of the stroke; default: as recorded, or the median's if irregular");
  command.add("--smooth", words->smooth, "window=N,order=M: Savitzky-Golay over N samples, an odd number")
      .comma_separated();
  command.add("--max-speed", words->max_speed, "faster jumps are refused [m/s]; default 5");
  command.add("--max-gap", words->max_gap, "longer gaps are refused, not bridged [s]; default 0.5");
  command.flag("--skip-bad-rows", words->skip_bad_rows, "leave bad rows out and say which, instead of refusing");
  command.add("--out", words->out, "the stroke; default: FILE_stroke.csv here");
  add_output_options(command, words->output);
  command.footer(
      "--columns: time, and position, orientation and force by the first of their columns, or each by itself as px, py, "
      "pz, qw, qx, qy, qz, mfx, mfy, mfz. --orientation is none, axis (the direction out of the tip), quat_wxyz, "
      "quat_xyzw, axis_angle (axis, angle) or matrix (r11, r12 ... r33, row by row); it turns the tool's frame into the "
      "world's.\n"
      "Rows with wrong numbers, times that do not increase, quaternions that are no unit and jumps are refused with their "
      "lines, and nothing is written.\n"
      "  hapbench import log.txt --preset hapi --smooth window=11,order=3 --out stroke.csv\n"
      "  hapbench import rec.csv --columns time=t,position=5,orientation=8,force=fx \\\n"
      "    --orientation quat_xyzw --scale time=1e-6,position=0.001");
  command.runs([words] { return import(*words); });
}

}  // namespace hapbench
