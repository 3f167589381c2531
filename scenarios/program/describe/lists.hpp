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

/// Returns the kinds of names that have lists, in the order of the lists.
std::span<const char* const> listed_kinds();
/// Returns the name of a kind's list: "depth_models" for the kind "depth model".
std::string list_name(const std::string& kind);
/// Returns true for the name of a kind's list, except "metrics", which describe_metrics() explains in full.
bool is_kind(const std::string& name);
/// Prints the entries of a kind or group if `options` name it, and only the entries that contain the text of --grep if
/// this option is given. If `options` have neither a name nor --grep, prints only the names of the entries of each
/// kind, without metrics, claims, assumptions and terms, because there are too many of these. Returns the exit status.
/// Throws InputError if no entry contains the text of --grep.
int list(const DescribeOptions& options, ProgramContext& context);

}  // namespace hapbench
