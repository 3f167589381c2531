#pragma once

#include <span>
#include <string>

#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"

/// The lists of `describe`.
namespace hapbench {

/// The options of `describe`.
struct DescribeOptions {
  std::string name, grep;
  OutputOptions output;
};

/// The kinds that lists have, in their order.
std::span<const char* const> listed_kinds();
/// The name of a kind's list: "depth_models".
std::string list_name(const std::string& kind);
/// True for the name of a kind's list. All metrics are told by a section of that name.
bool is_kind(const std::string& name);
/// Lists what is of a kind or a group, or of each kind but the many metrics and claims the names. Returns the exit
/// status.
int list(const DescribeOptions& options, ProgramContext& context);

}  // namespace hapbench
