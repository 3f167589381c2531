#pragma once

#include <filesystem>
#include <string>

namespace hapbench {

/// A folder of the files that come with the program: share/hapbench/NAME beside the folder of the running program,
/// installed or in a build tree. Throws InputError when it is not there.
std::filesystem::path installed_folder(const std::string& name);

}  // namespace hapbench
