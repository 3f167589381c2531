#include "scenarios/program/results_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                std::string_view option) {
  if (const auto error = context.directories.create(directory))
    throw InputError(fmt::format("{} {}: cannot be created: {}", option, directory.string(), error.message()));
  if (!std::filesystem::is_directory(directory))
    throw InputError(fmt::format("{} {}: is not a directory", option, directory.string()));
  if (access(directory.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("{} {}: cannot be written to", option, directory.string()));
}

std::filesystem::path results_directory(const std::string& out, const std::string& name) {
  return out.empty() ? std::filesystem::path("results") / "out" / name : std::filesystem::path(out);
}

}  // namespace hapbench
