#include "scenarios/program/results_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                const std::string& option) {
  const auto refuse = [&](const std::string& problem) {
    fail_in({.about_options = {option}}, fmt::format("{} {}: {}", option, directory.string(), problem));
  };
  if (const auto error = context.directories.create(directory)) refuse("cannot be created: " + error.message());
  if (!std::filesystem::is_directory(directory)) refuse("is not a directory");
  if (access(directory.c_str(), W_OK | X_OK) != 0) refuse("cannot be written to");
}

std::filesystem::path results_directory(const std::string& out, const std::string& name) {
  return out.empty() ? std::filesystem::path("results") / "out" / name : std::filesystem::path(out);
}

}  // namespace hapbench
