#include "scenarios/program/override_locations.hpp"

#include <fmt/format.h>

#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/overrides.hpp"

namespace hapbench {

namespace {

/// Replaces the file in the location of a fault by the override that set the faulty field. `pointer`: JSON pointer of
/// the field that the override sets.
void name_override(ErrorLocation& location, const std::string& override, const std::string& pointer) {
  constexpr std::size_t kMaxTypedLength = 60;
  const bool is_long = override.size() > kMaxTypedLength;
  // True if the location already has an option that the user typed, such as --device.
  const bool has_option = !location.option.empty();
  location.option +=
      fmt::format("{}--set {}{}", has_option ? ": " : "", override.substr(0, kMaxTypedLength), is_long ? "…" : "");
  location.about_options.emplace_back("--set");
  location.file.clear();
  if (location.pointer == pointer) location.pointer.clear();  // the override already names the field
}

}  // namespace

InputError with_override_locations(const InputError& error, const std::vector<std::string>& overrides) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    ErrorLocation location = fault.location();
    for (const std::string& override : overrides) {
      const std::string pointer = overridden_pointer(override);
      const bool is_in_it = location.pointer == pointer || location.pointer.starts_with(pointer + "/");
      if (!is_in_it || location.file.empty()) continue;
      name_override(location, override, pointer);
      break;
    }
    faults.emplace_back(fault.kind(), location, fault.problem());
  }
  return InputError::all(faults);
}

}  // namespace hapbench
