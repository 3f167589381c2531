#include "scenarios/description/integrator_codec.hpp"

#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {

CodecPtr<IntegratorFields> integrator_codec() {
  std::vector<std::pair<std::string, const IntegratorEntry*>> names;
  for (const IntegratorEntry* entry : kIntegrators) names.emplace_back(entry->info.name, entry);
  auto codec = object<IntegratorFields>();
  codec->required(
      "type", [](auto& i) -> const IntegratorEntry*& { return i.type; }, choice(std::move(names), "integrator"),
      "leapfrog is the thesis's; \"hapbench describe NAME\" explains each");
  return codec;
}

}  // namespace hapbench
