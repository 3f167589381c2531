#include "scenarios/program/describe/command_names.hpp"

#include <fmt/format.h>

#include <string>

#include "scenarios/program/commands.hpp"

namespace hapbench {

void add_commands(Index& index, const Layout& layout) {
  for (const CommandGuide& guide : command_guides()) {
    const std::string name(guide.name);
    Json json = {{"kind", "command"},
                 {"name", name},
                 {"meaning", guide.purpose},
                 {"options", fmt::format("hapbench {} --help", name)}};
    if (!guide.manual.empty()) json["manual"] = guide.manual;
    index.push_back(
        {"command", name, std::string(guide.purpose), [json, layout] { return entry_description(json, layout); }});
  }
}

}  // namespace hapbench
