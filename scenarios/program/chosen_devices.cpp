#include "scenarios/program/chosen_devices.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <system_error>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/names.hpp"

namespace hapbench {
namespace {

/// kPresets: text that selects all presets. kFile: ending of a device file's name.
constexpr const char *kPresets = "impedance", *kFile = ".json";

/// Returns true if the text is the path of a device file: it ends with ".json", contains "/", or is a pipe.
bool is_file(const std::string& name) {
  std::error_code error;
  return name.ends_with(kFile) || name.find('/') != std::string::npos || std::filesystem::is_fifo(name, error);
}

/// Returns the devices that an entry of --device selects, as defined at chosen_devices(); empty for an unknown entry.
std::vector<ComparedDevice> devices_named(const std::string& name) {
  if (is_file(name)) return {device_of_file(name)};
  std::vector<ComparedDevice> found;
  for (const ComparedDevice& device : compared_devices()) {
    if (name == "all" || name == device.name || (name == kPresets && device.published_stiffness))
      found.push_back(device);
    // A name with [soft] or [stiff] is one end of the range of unpublished parameters.
    for (const ComparedDevice& end : with_unpublished_numbers(device))
      if (name == end.name) found.push_back(end);
  }
  return found;
}

}  // namespace

std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  // Reject unknown names. Files and names with [soft] or [stiff] are checked below.
  std::vector<std::string> plain = given, all = names_of(compared_devices(), &ComparedDevice::name);
  std::erase_if(plain, [](const std::string& name) { return is_file(name) || name.ends_with(']'); });
  all.insert(all.begin(), {"FILE.json", kPresets});
  chosen_names("--device", plain, all, "hapbench describe presets");
  // Collect the devices of each name.
  std::vector<ComparedDevice> chosen;
  for (const std::string& name : given) {
    const std::vector<ComparedDevice> found = devices_named(name);
    if (found.empty())
      fail_in_option("--device", fmt::format("got \"{}\"; allowed: a preset, followed by [soft] or [stiff]", name));
    chosen.insert(chosen.end(), found.begin(), found.end());
  }
  // Reject a second device with the same name.
  std::set<std::string> names;
  for (const ComparedDevice& device : chosen) {
    if (names.insert(device.name).second) continue;
    fail_in_option(
        "--device",
        fmt::format(
            "got a second device named \"{}\"; allowed: each name once; the name of a file is its name without .json",
            device.name));
  }
  return chosen;
}

}  // namespace hapbench
