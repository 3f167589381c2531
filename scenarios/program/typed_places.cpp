#include "scenarios/program/typed_places.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides) {
  constexpr std::size_t kMostTyped = 60;
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    std::string place = fault.place();
    for (const std::string& override : overrides) {
      std::string pointer = "/" + std::string(overridden_path(override));
      std::ranges::replace(pointer, '.', '/');
      const std::size_t at = place.find(": " + pointer);
      if (at == std::string::npos) continue;
      const std::string rest = place.substr(at + 2 + pointer.size());
      if (!rest.empty() && !rest.starts_with('/')) continue;
      const std::size_t file = place.rfind(": ", at - 1);  // behind what else was typed, as --device
      const std::string typed = file == std::string::npos ? "" : place.substr(0, file + 2);
      const bool is_long = override.size() > kMostTyped;
      place = fmt::format("{}--set {}{}{}", typed, override.substr(0, kMostTyped), is_long ? "…" : "",
                          rest.empty() ? "" : ": " + pointer + rest);
      break;
    }
    faults.emplace_back(fault.kind(), place, fault.problem());
  }
  return InputError::all(faults);
}

}  // namespace hapbench
