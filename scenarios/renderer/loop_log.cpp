#include "scenarios/renderer/loop_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = "# hapbench loop log: ";
constexpr int kLogVersion = 1;

/// Calls visit(names, value) for each input and each output in a row of a log. `names`: names of the columns of this
/// value, separated by commas. `value`: the member of `in` or `out`.
template <class Visit>
void visit_row(HapbenchInput& in, HapbenchOutput& out, const Visit& visit) {
  visit("call", out.call);
  visit("time_ns", in.time_ns);
  visit("has", in.has);
  visit("hx_m,hy_m,hz_m", in.handle.position);
  visit("qw,qx,qy,qz", in.handle.orientation);
  visit("vx_m_per_s,vy_m_per_s,vz_m_per_s", in.velocity);
  visit("wx_rad_per_s,wy_rad_per_s,wz_rad_per_s", in.angular_velocity);
  visit("fhand_x_N,fhand_y_N,fhand_z_N", in.hand_force);
  visit("fapplied_x_N,fapplied_y_N,fapplied_z_N", in.applied_force);
  visit("input_reserved", in.reserved);
  visit("fx_N,fy_N,fz_N", out.force);
  visit("tx_N_m,ty_N_m,tz_N_m", out.torque);
  visit("set_x_m,set_y_m,set_z_m", out.set_position);
  visit("set_vx_m_per_s,set_vy_m_per_s,set_vz_m_per_s", out.set_velocity);
  visit("gain", out.gain);
  visit("dt_s", out.dt);
  visit("status", out.status);
  visit("contacts", out.contacts);
  visit("reason", out.reason);
  visit("limited", out.limited);
}

template <class Value>
std::span<Value> numbers_of(Value& value) {
  return {&value, 1};
}
template <class Value, std::size_t n>
std::span<Value> numbers_of(Value (&values)[n]) {
  return values;
}

std::string column_names() {
  HapbenchInput in = {};
  HapbenchOutput out = {};
  std::string names;
  visit_row(in, out, [&](const char* name, auto&) { names += (names.empty() ? "" : ",") + std::string(name); });
  return names;
}

std::string number_text(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr;
  return {text, end};
}
template <std::unsigned_integral Value>
std::string number_text(Value value) {
  return std::to_string(value);
}

Json pose_json(const HapbenchPose3& pose) {
  return {{"position_m", pose.position}, {"orientation_wxyz", pose.orientation}};
}

/// Returns a limit of the mount as JSON; null for infinity.
Json limit_json(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

double limit_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

/// Throws InputError if the object lacks one of the fields or has another field. `what`: name of the object.
void require_fields(const Json& json, std::initializer_list<std::string_view> fields, const char* what) {
  for (const std::string_view field : fields)
    if (!json.contains(field)) throw InputError(fmt::format("{} of the log: missing field \"{}\"", what, field));
  for (const auto& entry : json.items())
    if (std::ranges::find(fields, entry.key()) == fields.end())
      throw InputError(fmt::format("{} of the log: unknown field {}; allowed: {}", what, quoted_token(entry.key()),
                                   fmt::join(fields, ", ")));
}

template <std::size_t n>
void read_list(const Json& json, const char* field, double (&numbers)[n]) {
  const Json& list = json.at(field);
  if (list.size() != n) throw InputError(fmt::format("{}: got {} values; allowed: {}", field, list.size(), n));
  std::ranges::copy(list.get<std::vector<double>>(), numbers);
}

HapbenchPose3 pose_of(const Json& json, const char* what) {
  require_fields(json, {"position_m", "orientation_wxyz"}, what);
  HapbenchPose3 pose = {};
  read_list(json, "position_m", pose.position);
  read_list(json, "orientation_wxyz", pose.orientation);
  return pose;
}

std::uint32_t mode_of(const std::string& name) {
  for (const std::uint32_t mode : {HAPBENCH_IMPEDANCE, HAPBENCH_ADMITTANCE})
    if (name == mode_name(mode)) return mode;
  throw InputError(fmt::format("mode: got {}; allowed: {} or {}", quoted_token(name), mode_name(HAPBENCH_IMPEDANCE),
                               mode_name(HAPBENCH_ADMITTANCE)));
}

/// Reads the setup and the scenario of a log into `log`. `text`: JSON from the comment in the first line of the log.
/// Throws InputError.
void read_setup(std::string_view text, LoopLog& log) {
  const Json json = parse_json(std::string(text));
  try {
    require_fields(json, {"version", "scenario", "scenario_hash", "period_s", "mode", "torque", "mount"}, "setup");
    if (json.at("version").get<int>() != kLogVersion)
      throw InputError(fmt::format("got a log of version {}; allowed: {}", json.at("version").dump(), kLogVersion));
    log.scenario = {json.at("scenario").get<std::string>(), json.at("scenario_hash").get<std::string>(),
                    json.at("period_s").get<double>()};
    log.setup.mode = mode_of(json.at("mode").get<std::string>());
    log.setup.flags = json.at("torque").get<bool>() ? std::uint32_t{HAPBENCH_TORQUE} : 0;
    const Json& mount = json.at("mount");
    require_fields(mount,
                   {"world_from_device", "scale", "handle_from_tip", "max_force_N", "max_force_rate_N_per_s", "ramp_s",
                    "stale_s", "engage_force_N"},
                   "mount");
    log.setup.mount = {pose_of(mount.at("world_from_device"), "world_from_device"),
                       mount.at("scale").get<double>(),
                       pose_of(mount.at("handle_from_tip"), "handle_from_tip"),
                       limit_of(mount.at("max_force_N")),
                       limit_of(mount.at("max_force_rate_N_per_s")),
                       mount.at("ramp_s").get<double>(),
                       limit_of(mount.at("stale_s")),
                       limit_of(mount.at("engage_force_N"))};
    check_mount(log.setup);
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("the setup of the log cannot be read: {}", problem.what()));
  }
}

/// Reads a row. Throws InputError without a location.
void read_row(std::string_view line, const Words& names, HapbenchInput& in, HapbenchOutput& out) {
  const Words cells = parts_of(line, ',');
  if (cells.size() != names.size())
    throw InputError(fmt::format("got {} cells; allowed: {}", cells.size(), names.size()));
  std::size_t next = 0;
  visit_row(in, out, [&](const char*, auto& values) {
    for (auto& value : numbers_of(values)) {
      using Value = std::remove_reference_t<decltype(value)>;
      const auto number = parse_number<Value>(cells[next]);
      if (!number)
        throw InputError(fmt::format("{}: got {}; allowed: {}", names[next], quoted_token(cells[next]),
                                     std::is_integral_v<Value> ? "an integer from 0" : "a number"));
      value = *number;
      ++next;
    }
  });
}

}  // namespace

std::string log_header(const RendererSetup& setup, const LoggedScenario& scenario) {
  const HapbenchMount& mount = setup.mount;
  const Json json = {{"version", kLogVersion},
                     {"scenario", scenario.name},
                     {"scenario_hash", scenario.hash},
                     {"period_s", scenario.period},
                     {"mode", mode_name(setup.mode)},
                     {"torque", (setup.flags & HAPBENCH_TORQUE) != 0},
                     {"mount",
                      {{"world_from_device", pose_json(mount.world_from_device)},
                       {"scale", mount.scale},
                       {"handle_from_tip", pose_json(mount.handle_from_tip)},
                       {"max_force_N", limit_json(mount.max_force)},
                       {"max_force_rate_N_per_s", limit_json(mount.max_force_rate)},
                       {"ramp_s", mount.ramp_s},
                       {"stale_s", limit_json(mount.stale_s)},
                       {"engage_force_N", limit_json(mount.engage_force)}}}};
  return std::string(kMark) + json.dump() + "\n" + column_names() + "\n";
}

std::string log_row(const HapbenchInput& given_input, const HapbenchOutput& given_output) {
  HapbenchInput in = given_input;
  HapbenchOutput out = given_output;
  std::string line;
  visit_row(in, out, [&](const char*, auto& values) {
    for (const auto& value : numbers_of(values)) line += (line.empty() ? "" : ",") + number_text(value);
  });
  return line + "\n";
}

LoopLog read_loop_log(const fs::path& file) {
  const std::string text = read_named_file(file);
  const std::string header = column_names();
  const Words names = parts_of(header, ',');
  LoopLog log;
  bool has_setup = false, has_header = false;
  LineReader lines(text);
  while (const auto next = lines.next()) {
    const std::string_view line = trimmed(*next);
    if (line.empty()) continue;
    try {
      if (!has_setup) {
        if (!line.starts_with(kMark))
          throw InputError(
              fmt::format("is not a log of a haptic loop; allowed: a first line \"{}{{…}}\", as "
                          "hapbench_renderer_log_header writes it",
                          kMark));
        read_setup(line.substr(kMark.size()), log);
        has_setup = true;
      } else if (!has_header) {
        if (line != header) throw InputError("the columns are not those of a log; allowed: " + header);
        has_header = true;
      } else {
        HapbenchInput in = {};
        HapbenchOutput out = {};
        read_row(line, names, in, out);
        if (out.call != log.inputs.size())
          throw InputError(
              fmt::format("got call {} where call {} is expected; allowed: every call from 0, because the "
                          "forces depend on all calls before",
                          out.call, log.inputs.size()));
        log.inputs.push_back(in);
        log.outputs.push_back(out);
      }
    } catch (const InputError& error) {
      fail_in_line(file, lines.line(), error.what());
    }
  }
  if (log.inputs.empty()) fail_in_file(file, "has no calls; allowed: a log with a row for every call");
  return log;
}

std::vector<HapbenchOutput> replayed(HapbenchRenderer& renderer, const LoopLog& log,
                                     const std::function<void(std::size_t, const HapbenchOutput&)>& after_call) {
  std::vector<HapbenchOutput> outputs(log.inputs.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    hapbench_renderer_step(&renderer, &log.inputs[i], &outputs[i]);
    after_call(i, outputs[i]);
  }
  return outputs;
}

ReplayComparison compare_outputs(const std::vector<HapbenchOutput>& a, const std::vector<HapbenchOutput>& b) {
  ReplayComparison comparison = {a.size(), 0, 0.0, a.size()};
  for (std::size_t i = 0; i < a.size(); ++i) {
    // Compare numbers of type double by their bits, and integers by their values.
    HapbenchInput none = {};
    HapbenchOutput one = a[i], other = b[i];
    std::vector<std::uint64_t> bits[2];
    for (const auto& [output, list] : {std::pair{&one, &bits[0]}, {&other, &bits[1]}}) {
      visit_row(none, *output, [&, &into = *list](const char*, auto& values) {
        for (const auto& value : numbers_of(values)) {
          if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>)
            into.push_back(std::bit_cast<std::uint64_t>(value));
          else
            into.push_back(value);
        }
      });
    }
    if (bits[0] == bits[1])
      ++comparison.equal;
    else
      comparison.first_other = std::min(comparison.first_other, i);
    const Eigen::Map<const Vec3> force(one.force), other_force(other.force);
    comparison.largest = std::max(comparison.largest, (force - other_force).norm());
  }
  return comparison;
}

}  // namespace hapbench
